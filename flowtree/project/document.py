"""A document: its state, and every state before it, to undo to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from flowtree.project.apply_command import apply_command
from flowtree.project.commands import SETTING, Command, target_of
from flowtree.project.document_state import DocumentState

_MOST_STEPS = 400  # that can be undone; the oldest fall away


@dataclass(frozen=True)
class Step:
    """One command of the history.

    Attributes:
        command: what was done.
        gesture: under which it was; None for one by itself.
    """

    command: Command
    gesture: str | None = None


class Document:
    """A state and its history; commands are the only way to change it.

    Attributes:
        revision: grows by one with every change, also when something is undone.
    """

    def __init__(
        self, base: DocumentState | None = None, steps: Iterable[Step] = (), position: int | None = None
    ) -> None:
        """Builds a document by doing all steps again.

        Args:
            base: the state before the first step; None is an empty one.
            steps: what was done.
            position: how many of the steps count; the others can be redone. None takes all.

        Raises:
            InputError: a step does not follow from those before it.
        """
        self._states = [DocumentState() if base is None else base]
        self._steps: list[Step] = []
        for step in steps:
            self._steps.append(step)
            self._states.append(apply_command(step.command, self._states[-1]))
        self._position = len(self._steps) if position is None else min(max(position, 0), len(self._steps))
        self.revision = 0

    @property
    def state(self) -> DocumentState:
        """As it stands now."""
        return self._states[self._position]

    @property
    def base(self) -> DocumentState:
        """The oldest state that can be undone to."""
        return self._states[0]

    @property
    def steps(self) -> tuple[Step, ...]:
        """From the base on, those that can be redone among them."""
        return tuple(self._steps)

    @property
    def position(self) -> int:
        """How many of the steps count."""
        return self._position

    @property
    def to_undo(self) -> Command | None:
        """The last command."""
        return self._steps[self._position - 1].command if self._position > 0 else None

    @property
    def to_redo(self) -> Command | None:
        """The command that was undone last."""
        return self._steps[self._position].command if self._position < len(self._steps) else None

    def states(self) -> tuple[DocumentState, ...]:
        """All that can be undone or redone to."""
        return tuple(self._states)

    def copy(self) -> Document:
        """The same, to be kept while this one goes on."""
        other = Document(self._states[0])
        other._states, other._steps = list(self._states), list(self._steps)
        other._position, other.revision = self._position, self.revision
        return other

    def apply(self, command: Command, gesture: str | None = None) -> DocumentState:
        """Does a command; what could be redone is gone.

        A command that sets the same thing as the last one, in the same gesture, takes its place: dragging a
        slider is one step.

        Raises:
            InputError: the command breaks a rule; nothing has changed.
        """
        state = apply_command(command, self.state)
        if state == self.state:
            return self.state
        del self._steps[self._position :], self._states[self._position + 1 :]
        if self._goes_on(command, gesture):
            del self._steps[-1], self._states[-1]
        self._steps.append(Step(command, gesture))
        self._states.append(state)
        spare = len(self._steps) - _MOST_STEPS
        if spare > 0:
            del self._steps[:spare], self._states[:spare]
        self._position = len(self._steps)
        self.revision += 1
        return state

    def undo(self) -> bool:
        """Goes back one step; false if there is none."""
        if self._position == 0:
            return False
        self._position -= 1
        self.revision += 1
        return True

    def redo(self) -> bool:
        """Does again what was undone last; false if there is nothing."""
        if self._position == len(self._steps):
            return False
        self._position += 1
        self.revision += 1
        return True

    def _goes_on(self, command: Command, gesture: str | None) -> bool:
        if gesture is None or not self._steps or not isinstance(command, SETTING):
            return False
        last = self._steps[-1]
        return last.gesture == gesture and target_of(last.command) == target_of(command)
