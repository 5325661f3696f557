"""C without its comments, which contain the equations; annotations for the analyser stay."""

import re


def without_comments(text: str) -> str:
    """Return the text without comments of the form /* .. */, but with those of the form /*@ .. */."""
    return re.sub(r"/\*(?!@).*?\*/", "", text, flags=re.DOTALL)
