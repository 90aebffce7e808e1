"""Maps of streams: one chunk of points at a time."""

from __future__ import annotations

from typing import Iterable, Iterator

from numpy.typing import ArrayLike

from ._verisq import Map, Mapper, Model


def map_chunks(
    model: Model,
    chunks: Iterable[ArrayLike],
    *,
    tolerance: float | None = None,
    device: str = "auto",
    point_radius: float = 0.0,
    certificates: bool = False,
) -> Iterator[Map]:
    """Maps a stream: yields a Map for each array of points that `chunks` delivers.

    Memory is that of one chunk; chunks of 100,000 points and more keep a device busy. Arguments and errors are those
    of map(); the model is made ready when the first map is asked for.
    """
    mapper = Mapper(
        model, tolerance=tolerance, device=device, point_radius=point_radius, certificates=certificates
    )
    for points in chunks:
        yield mapper(points)
