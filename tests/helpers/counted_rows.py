"""An array that counts the entries read. The count shows, without a clock, work that grows faster than the structure."""

from typing import Any, ClassVar

import numpy as np


class Counted(np.ndarray):
    """An array that counts its entries as they are compared or picked. All such arrays share one count, `read`, which a test sets to 0."""

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
