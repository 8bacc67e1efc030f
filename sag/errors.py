"""Errors that a user can act on."""


class SagError(Exception):
    """A mistake in the input, said in one sentence that names the file, field or flag and the way out.

    The command line prints the sentence alone and exits with a status other than zero.
    """
