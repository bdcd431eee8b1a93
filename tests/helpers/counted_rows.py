"""An array that counts how many of its entries are read: work that grows faster than a structure is found without a clock."""

from typing import Any, ClassVar

import numpy as np


class Counted(np.ndarray):
    """An array whose entries are counted as they are compared or picked; the count `read` is one for all such arrays, to be set to 0."""

    read: ClassVar[int] = 0

    @classmethod
    def of(cls, values: np.ndarray) -> "Counted":
        return np.array(values).view(cls)

    def __getitem__(self, key: Any) -> Any:
        found = np.asarray(self)[key]
        Counted.read += np.size(found)
        return found

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        Counted.read += sum(one.size for one in inputs if isinstance(one, Counted))
        return getattr(ufunc, method)(*(np.asarray(one) if isinstance(one, Counted) else one for one in inputs), **options)
