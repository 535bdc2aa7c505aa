"""A running camera's parameters, source, recording and diagnosis, over the daemon's REST interface."""

import json
import os
import urllib.error
import urllib.request
from collections.abc import Mapping
from http.client import HTTPException
from pathlib import Path
from typing import Any
from urllib.parse import quote

from voltcam_client.errors import ControlError

DEFAULT_URL = "http://127.0.0.1:8560"
TOKEN_VARIABLE = "VOLTCAM_TOKEN"
LONGEST_S = 90.0  # for a change: a stream may take a minute to open, a recording some time to be finished
Json = dict[str, Any]


class Control:
    """The Voltcam daemon at an HTTP address.

    - `url`: `http://HOST:PORT`, or https.
    - `timeout_s`: how long it waits for an answer; for that to a change 90 s at least.
    - `token`: of a daemon that asks for one; None: that of VOLTCAM_TOKEN.
    - `camera`: which, of a daemon that has several; None: its first.

    Each method returns the daemon's answer, a dict. It raises ControlError, in one line, when the daemon
    refuses or does not answer in time. A refused change has changed nothing.
    """

    def __init__(
        self,
        url: str = DEFAULT_URL,
        *,
        timeout_s: float = 5.0,
        token: str | None = None,
        camera: str | None = None,
    ) -> None:
        if not url.startswith(("http://", "https://")):
            raise ControlError(f"{url!r} is not an address of a daemon: give http://HOST:PORT")
        self.url = url.rstrip("/")
        self.timeout_s = timeout_s
        self._query = f"?camera={quote(camera)}" if camera is not None else ""
        self._token = token if token is not None else os.environ.get(TOKEN_VARIABLE, "")
        # Straight to the daemon: a proxy from the environment is for the outside world.
        self._opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))

    def cameras(self) -> list[Json]:
        """All cameras of the daemon, with their names."""
        return list(self._ask("GET", "/cameras", None, list))

    def camera(self) -> Json:
        """Name, width, height and addresses of the camera."""
        return self._request("GET", "/camera")

    def parameters(self) -> Json:
        """All parameters, nested by effect."""
        return self._request("GET", "/parameters")

    def set(self, changes: Mapping[str, Any]) -> Json:
        """Change parameters, all at once, between two frames.

        Either nested, `{"comparator": {"theta_on": 1.2}}`, or by path, `{"comparator.theta_on": 1.2}`.
        """
        return self._request("PATCH", "/parameters", _nested(changes))

    def schema(self) -> Json:
        """The parameters' JSON schema: unit, limits and meaning of each."""
        return self._request("GET", "/parameters/schema")

    def biases(self) -> Json:
        """The biases of a DAVIS with the parameters of now: `{"ONBn_coarse": 6, "ONBn_fine": 200, ...}`."""
        return self._request("GET", "/biases")

    def set_biases(self, changes: Mapping[str, int]) -> Json:
        """Change biases, named as drivers of a DAVIS name them, and the parameters that depend on them."""
        return self._request("PATCH", "/biases", dict(changes))

    def source(self) -> Json:
        """What the camera looks at."""
        return self._request("GET", "/source")

    def set_source(self, uri: str, **options: Any) -> Json:
        """Look at something else: an address as for `voltcam serve --source`, and options such as fps=30."""
        return self._request("PUT", "/source", {"uri": uri, **options})

    def start_recording(self, path: str | Path) -> Json:
        """Record into a file on the daemon's host."""
        return self._request("POST", "/recording", {"path": str(path)})

    def stop_recording(self) -> Json:
        """End the recording."""
        return self._request("DELETE", "/recording")

    def start_diagnosis(
        self, reference: str | Path | None = None, *, stream: str | None = None, seconds: float | None = None
    ) -> Json:
        """Find what the camera lacks to be like another: one that made the recording `reference` on the
        daemon's host, or that looks at the same scene now and sends to the ZeroMQ address `stream`. Of it,
        `seconds` are looked at. The answer is `diagnosis()` at its beginning."""
        given = {"reference": reference and str(reference), "stream": stream, "seconds": seconds}
        body = {key: value for key, value in given.items() if value is not None}
        return self._request("POST", "/diagnosis", body)

    def diagnosis(self) -> Json:
        """State (idle, gathering, running, done, failed), sentences of progress, and the result when done."""
        return self._request("GET", "/diagnosis")

    def end_diagnosis(self) -> Json:
        """End it before it is done."""
        return self._request("DELETE", "/diagnosis")

    def accept_diagnosis(self) -> Json:
        """Run with what was found; the answer says the new parameters_version."""
        return self._request("POST", "/diagnosis/accept")

    def revert_diagnosis(self) -> Json:
        """Back to the parameters from before the last accept; the answer says their new version."""
        return self._request("POST", "/diagnosis/revert")

    def status(self) -> Json:
        """Rates, drops, state of the source and of the recording."""
        return self._request("GET", "/status")

    @property
    def _headers(self) -> dict[str, str]:
        kind = {"Content-Type": "application/json"}
        return kind | {"Authorization": f"Bearer {self._token}"} if self._token else kind

    def _request(self, method: str, path: str, body: Json | None = None) -> Json:
        return dict(self._ask(method, path, body, dict))

    def _ask(self, method: str, path: str, body: Json | None, kind: type) -> Any:
        url = f"{self.url}/api/v1{path}{self._query}"
        data = None if body is None else json.dumps(body).encode()
        timeout_s = self.timeout_s if method == "GET" else max(self.timeout_s, LONGEST_S)
        try:
            request = urllib.request.Request(url, data, self._headers, method=method)
            with self._opener.open(request, timeout=timeout_s) as response:
                answer = json.loads(response.read() or b"{}")
        except urllib.error.HTTPError as error:
            with error:
                raise ControlError(_detail(error), error.code) from error
        except json.JSONDecodeError as error:
            raise ControlError(f"{url} did not answer in JSON: is it a Voltcam daemon?") from error
        except TimeoutError as error:  # connected, or it would be the reason of a URLError
            later = "" if method == "GET" else ", and may still do it"
            raise ControlError(
                f"{url} did not answer within {timeout_s:g} s{later}: give Control(timeout_s=...)"
            ) from error
        except (OSError, HTTPException, ValueError) as error:
            reason = getattr(error, "reason", error)
            raise ControlError(
                f"cannot reach {self.url} ({reason}): is `voltcam serve` running there?"
            ) from error
        if not isinstance(answer, kind):
            raise ControlError(f"{url} did not answer as it should: is it a Voltcam daemon?")
        return answer


def _nested(changes: Mapping[str, Any]) -> Json:
    """{"a.b": 1, "c": {"d": 2}} to {"a": {"b": 1}, "c": {"d": 2}}."""
    nested: Json = {}
    for path, value in changes.items():
        *effects, name = path.split(".")
        inner = nested
        for effect in effects:
            inner = inner.setdefault(effect, {})
        if isinstance(value, Mapping):
            inner.setdefault(name, {}).update(value)
        else:
            inner[name] = value
    return nested


def _detail(error: urllib.error.HTTPError) -> str:
    """The daemon's reason: its own {"detail": "one line"}, or FastAPI's {"detail": [{"loc", "msg"}]}."""
    try:
        detail = json.loads(error.read())["detail"]
        if isinstance(detail, list):
            detail = "; ".join(f"{_place(item['loc'])}: {item['msg']}" for item in detail)
    except (ValueError, KeyError, TypeError, OSError):
        detail = f"{error.url} answered {error.code} {error.reason}: is it a Voltcam daemon?"
    return " ".join(str(detail).split())


def _place(location: list[str | int]) -> str:
    return ".".join(str(part) for part in location if part != "body")
