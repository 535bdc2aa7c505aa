"""The bytes of iniVation's DV: what its network streams and its AEDAT4 files are made of.

Both are flatbuffers, made and read here with numpy alone: a header that says which streams there are
(`streams`), and packets of events, frames, IMU samples and triggers (`packets`).

Sources: the schemas and the layouts are those of dv-processing 2.0.4, told by the bytes that it writes;
iniVation's documentation of AEDAT 4.0; the flatbuffers project's description of its binary format.
"""
