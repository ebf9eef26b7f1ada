# SPDX-License-Identifier: Apache-2.0
"""Errors: each has the C interface's sentence as its text and its status."""
from . import _c


class Error(Exception):
    """Base of all errors of the package. `status` is the number that the C interface returned."""
    status = 1


class InternalError(Error):
    """A defect of the library."""


class OrderError(Error):
    """A call that does not fit what was done before."""
    status = 2


class InputError(Error, ValueError):
    """The scene, a mesh or an array is wrong; the text names the place and the value."""
    status = 3


class DeviceError(Error):
    """No such device, backend or route."""
    status = 4


class NumericalError(Error, ArithmeticError):
    """The promised accuracy cannot be kept; results so far can be read."""
    status = 5


class HandleError(Error):
    """What was used is closed already."""
    status = 7


class SizeError(Error, ValueError):
    """An array of another size."""
    status = 8


class AllowedError(Error, ValueError):
    """An index or a value outside what is allowed, or not finite."""
    status = 10


class BusyError(Error):
    """In use by another call, perhaps on another thread."""
    status = 11


class OutOfMemory(Error, MemoryError):
    """Out of memory."""
    status = 12


class Cancelled(Error):
    """A callback or cancel() asked for it; the results of a step that ended early can be read."""
    status = 13


_BY_STATUS = {e.status: e for e in (OrderError, InputError, DeviceError, NumericalError, HandleError,
                                    SizeError, AllowedError, BusyError, OutOfMemory, Cancelled)}
_last_error = _c.library.sunder_last_error


def check(status: int) -> None:
    """Raises what a status other than 0 stands for."""
    if status == 0:
        return
    error = _BY_STATUS.get(status, InternalError)((_last_error() or b"").decode("utf-8", "replace"))
    error.status = status
    raise error
