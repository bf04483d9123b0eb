"""The compiled part: what `Problem` and `Branch` are made of."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__version__: str

class EngineError(ValueError): ...
class OutsidePattern(ValueError): ...

Progress = Callable[[int, int, float, float], object] | None
Settings = dict[str, Any]
Watches = list[dict[str, Any]]
Outcome = tuple[Any, BaseException | None]

def make_engine(
    n: int,
    f: Callable[..., Any],
    jac: Callable[..., Any] | None,
    slope: Callable[..., Any] | None,
    parameters: list[tuple[str, str, float]],
    observe: list[tuple[str, Callable[..., Any]]],
    stability: str | None,
    pattern: Any,
    mass: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]] | None,
    metric: list[float] | None,
) -> Engine: ...

class Engine:
    @property
    def storage(self) -> str: ...
    def trace(
        self,
        parameter: str,
        u: list[float],
        p: list[float],
        settings: Settings,
        watches: Watches,
        progress: Progress,
    ) -> Outcome: ...
    def both_ways(
        self,
        parameter: str,
        u: list[float],
        p: list[float],
        settings: Settings,
        watches: Watches,
        progress: Progress,
    ) -> Outcome: ...
    def restart(
        self,
        branch: RawBranch,
        point: int,
        settings: Settings,
        watches: Watches,
        progress: Progress,
    ) -> Outcome: ...
    def leave(
        self,
        branch: RawBranch,
        event: int,
        direction: int,
        forward: bool,
        settings: Settings,
        watches: Watches,
        progress: Progress,
    ) -> Outcome: ...
    def curve(
        self,
        branch: RawBranch,
        event: int,
        second: str,
        settings: Settings,
        watches: Watches,
        progress: Progress,
    ) -> Outcome: ...
    def diagram(
        self,
        parameter: str,
        u: list[float],
        p: list[float],
        settings: Settings,
        watches: Watches,
        progress: Progress,
    ) -> Outcome: ...
    def newton(
        self, u: list[float], p: list[float], tolerance: float, max_iterations: int
    ) -> Outcome: ...
    def modes(self, u: list[float], p: list[float], count: int) -> Outcome: ...
    def check(self, u: list[float], p: list[float], scale: float) -> Outcome: ...
    def deflate(
        self,
        p: list[float],
        known: list[list[float]],
        starts: list[list[float]],
        branches: list[RawBranch],
        states: int,
        settings: Settings,
    ) -> Outcome: ...
    def disconnected(
        self, branches: list[RawBranch], values: list[float], settings: Settings
    ) -> Outcome: ...
    def near(self, branch: RawBranch) -> Outcome: ...

class RawBranch:
    def __len__(self) -> int: ...
    @property
    def parameter(self) -> str: ...
    @property
    def parameters(self) -> NDArray[np.float64]: ...
    @property
    def observables(self) -> list[str]: ...
    @property
    def dim(self) -> int: ...
    @property
    def stopped(self) -> tuple[tuple[str, str], tuple[str, str] | None]: ...
    @property
    def is_complete(self) -> bool: ...
    @property
    def is_certain(self) -> bool: ...
    @property
    def doubts(self) -> list[tuple[float, float, str]]: ...
    @property
    def statistics(self) -> dict[str, int]: ...
    def column(self, name: str) -> NDArray[np.float64]: ...
    def u(self, index: int) -> NDArray[np.float64]: ...
    def states(self) -> NDArray[np.float64]: ...
    def point(self, index: int) -> dict[str, Any]: ...
    def events(self) -> list[dict[str, Any]]: ...
    def to_csv(self) -> str: ...
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(bytes: bytes) -> RawBranch: ...

class RawCase:
    @property
    def name(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    def to_toml(self) -> str: ...
    def trace(self, progress: Progress) -> tuple[dict[str, Any], BaseException | None]: ...
    def diagram(self, progress: Progress) -> tuple[dict[str, Any], BaseException | None]: ...
    def cycle(self, progress: Progress) -> tuple[dict[str, Any], BaseException | None]: ...
    def map(self, over: str, progress: Progress) -> tuple[dict[str, Any], BaseException | None]: ...

def find_case(what: str, keys: list[str]) -> RawCase: ...
def parse_case(name: str, text: str, keys: list[str]) -> RawCase: ...
def list_cases() -> tuple[list[str], list[tuple[str, str]]]: ...
