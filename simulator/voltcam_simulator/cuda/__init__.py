"""The pixels on a GPU, a thread for each: the kernels of a processor, compiled by numba-cuda as they are.

`CudaPixels` takes the place of `PixelArray`. All that needs numba-cuda is in here, and imported only where a
simulator is asked for device "cuda".
"""
