"""Who may reach the daemon, and what they may ask of it."""

from .guard import Guard
from .paths import AccessError, resolve_under
from .session import session_routes
from .settings import AccessSettings
from .sources import SourceRules
from .tokens import Role, Tokens

__all__ = [
    "AccessError",
    "AccessSettings",
    "Guard",
    "Role",
    "SourceRules",
    "Tokens",
    "resolve_under",
    "session_routes",
]
