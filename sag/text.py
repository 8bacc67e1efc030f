"""Text for a terminal."""


def plain(text: str) -> str:
    """The text with what would move the cursor, or cannot be written, spelt out: file names may hold anything."""
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text)
