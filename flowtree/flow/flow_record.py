"""What a flow leaves behind before it is joined to a tree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class FlowRecord:
    """Where every particle was at the beginning of each step in which it was under way.

    Attributes:
        blocks: pieces one after the other, as they were recorded: points (m_k, 3) float32 [m] and particles
            (m_k,) int32, step after step.
        begin: (steps + 1,) int64, where in all of them a step begins.
        begin_step: (n,) int32, the step in which each particle set off; -1 for never.
        end_step: (n,) int32, the last step that it is recorded in; -1 for who was still under way.
        joined: (n,) int32, the particle that it went over to; -1 for none.
    """

    blocks: tuple[tuple[NDArray[np.float32], NDArray[np.int32]], ...]
    begin: NDArray[np.int64]
    begin_step: NDArray[np.int32]
    end_step: NDArray[np.int32]
    joined: NDArray[np.int32]

    @classmethod
    def of_nobody(cls) -> FlowRecord:
        """The record of no particle."""
        none = np.zeros(0, np.int32)
        return cls(((np.zeros((0, 3), np.float32), none),), np.zeros(1, np.int64), none, none, none)

    @property
    def points(self) -> NDArray[np.float32]:
        """(m, 3) [m]."""
        return np.concatenate([points for points, _ in self.blocks])

    @property
    def particle(self) -> NDArray[np.int32]:
        """(m,) whose point it is."""
        return np.concatenate([particle for _, particle in self.blocks])

    @property
    def step(self) -> NDArray[np.int32]:
        """(m,) the step at whose beginning it was there."""
        return np.repeat(np.arange(len(self.begin) - 1, dtype=np.int32), np.diff(self.begin))

    @property
    def particle_steps(self) -> int:
        """Points recorded: the sum of the numbers of particles under way over all steps."""
        return int(self.begin[-1])
