# SPDX-License-Identifier: Apache-2.0
"""Arrays on their way into the library: checked, of its type, dense."""
import numpy as np

from .errors import InputError


def _shape_text(shape):
    return "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"


def _checked(value, what, shape, dtype, kinds):
    try:
        array = np.asarray(value)
    except (ValueError, TypeError) as error:
        raise InputError(f"{what}: not an array of numbers: {error}") from None
    if array.size == 0 and array.dtype == np.float64:
        array = array.astype(dtype)  # of an empty list
    if array.dtype.kind not in kinds:
        raise InputError(f"{what} has the type {array.dtype}; allowed are "
                         + ("numbers" if "f" in kinds else "whole numbers"))
    fits = array.ndim == len(shape) and all(n is None or n == m for n, m in zip(shape, array.shape))
    if not fits:
        raise InputError(f"{what} has the shape {array.shape}; allowed is {_shape_text(shape)}")
    return array


def reals(value, what, shape):
    """float64, dense, of that shape (None: any). A copy only where the type or the order in memory
    asks for one. Raises InputError, also where a value is not finite."""
    array = np.ascontiguousarray(_checked(value, what, shape, np.float64, "fiu"), dtype=np.float64)
    if not np.isfinite(array).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise InputError(f"{what} has {array[place]} at {place}; allowed are finite numbers")
    return array


def ids(value, what, shape):
    """int32, dense, of that shape. Raises InputError, also where a number has no place in 32 bits."""
    array = _checked(value, what, shape, np.int32, "iu")
    if array.size and (array.min() < -2**31 or array.max() >= 2**31):
        raise InputError(f"{what} has a number that 32 bits do not hold")
    return np.ascontiguousarray(array, dtype=np.int32)


def room(out, what, shape, dtype):
    """Where the library writes: a new array, or the caller's."""
    if out is None:
        return np.empty(shape, dtype)
    if not isinstance(out, np.ndarray) or out.dtype != dtype or out.shape != tuple(shape):
        raise InputError(f"out of {what} is not an array of type {np.dtype(dtype)} and shape {shape}")
    if not out.flags.c_contiguous or not out.flags.writeable:
        raise InputError(f"out of {what} is read-only or not dense row by row")
    return out
