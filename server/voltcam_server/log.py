"""How the log is written: for people, or an object a line."""

import json
import logging
import sys
import time
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

log = logging.getLogger("voltcam")
OWN = set(vars(logging.makeLogRecord({})))  # what every record has


class LogSettings(BaseModel):
    """Lines on standard error."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["text", "json"] = Field(
        default="text", description="text: for people; json: an object a line, for programs that gather logs"
    )
    rates_s: float = Field(
        default=0, ge=0, le=86_400, description="seconds between lines with the rates; 0: no such lines"
    )


class JsonLines(logging.Formatter):
    """Time, level, logger, message, and the fields given as `extra`."""

    def format(self, record: logging.LogRecord) -> str:
        line = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created))
            + f".{record.msecs:03.0f}Z",
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        line |= {key: value for key, value in vars(record).items() if key not in OWN}
        if record.exc_info:
            line["error"] = self.formatException(record.exc_info)
        return json.dumps(line, default=str)


def begin_log(settings: LogSettings) -> None:
    """Have the log written to standard error."""
    handler = logging.StreamHandler(sys.stderr)
    text = logging.Formatter("%(asctime)s %(levelname)s %(message)s", "%Y-%m-%d %H:%M:%S")
    handler.setFormatter(JsonLines() if settings.format == "json" else text)
    logging.basicConfig(handlers=[handler], level=logging.WARNING, force=True)
    log.setLevel(logging.INFO)
