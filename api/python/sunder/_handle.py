# SPDX-License-Identifier: Apache-2.0
"""What scenes and simulations have in common: a handle of the C interface, given back once."""
from __future__ import annotations

from typing import TypeVar

import numpy as np

from .errors import HandleError

_Self = TypeVar("_Self", bound="Handled")


class Lent:
    """Memory of the library as numpy sees it, read-only; keeps whose it is from being given back."""

    def __init__(self, owner, address, shape, dtype):
        self._owner = owner
        self.__array_interface__ = {"version": 3, "shape": tuple(shape), "typestr": np.dtype(dtype).str,
                                    "data": (address, True)}


class Owner:
    """Gives a handle back when nothing refers to it any more."""

    def __init__(self, handle, destroy):
        self.handle, self._destroy = handle, destroy

    def __del__(self):
        self._destroy(self.handle)


class Handled:
    """Gives its handle back at the end of a `with`, by close(), or when nothing refers to it."""

    _handle: int | None = None
    _what = ""  # in words

    def _destroy(self, handle: int) -> None:
        raise NotImplementedError

    def __enter__(self: _Self) -> _Self:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __del__(self):
        self.close()

    def close(self) -> None:
        """Gives its memory back; what was made of it lives on."""
        handle, self._handle = self._handle, None
        if handle:
            self._destroy(handle)

    @property
    def handle(self) -> int:
        """The number by which the C interface knows it."""
        if not self._handle:
            raise HandleError(f"the {self._what} is closed")
        return self._handle
