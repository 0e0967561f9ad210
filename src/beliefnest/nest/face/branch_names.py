"""Names of branches."""

from beliefnest.errors import BranchError

__all__ = ["check_branch_name"]


def check_branch_name(name: object) -> None:
    """Refuse what can name no branch; BranchError says so."""
    if not isinstance(name, str) or not name or not name.isprintable() or set(name) & set("/[]"):
        raise BranchError(
            f"{name!r} is not a branch name; use printable text without '/', '[' and ']'"
        )
