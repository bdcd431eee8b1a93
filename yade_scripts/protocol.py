"""The loading protocol: rest under gravity, then one steady settlement of the support until the reaction is constant."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from yade import Omega

from la_core.exchange import GRAVITY, SETTLEMENT
from yade_scripts import plateau
from yade_scripts.bodies import Model, set_loads
from yade_scripts.case import Case
from yade_scripts.contacts.near_faces import NearFaces
from yade_scripts.driving import Servo, SwingDamper, ramp, servo_of, set_speed, swing_damper
from yade_scripts.faults import is_restless, jumps, loss_of, settlement_words
from yade_scripts.plateau import Outcome, Plateau
from yade_scripts.plateau_search import PlateauSearch
from yade_scripts.recorder import Record, Row, Status
from yade_scripts.settings import CRITICAL, Settings

ROWS_BETWEEN_FITS, ROWS_BETWEEN_LOOKS = 20, 4
ROWS_AT_REST = 3  # successive rows at rest: a swinging block passes through balance in one row and stands still in another
GRAVITY_ROWS = 2000  # rows of the longest gravity stage
FIRST_POSE = 1.0 / 32.0  # of the distance between stored states, less for stiffer joints: forces change most as joints lose their strain
EARLY_POSES = 32  # stored states between the joints' loss of strain and the first settlement at which the run may stop
LATE_POSES = 0.1  # of the settlement so far: largest distance between later states, so that every plateau has several states
Progress = Callable[[str, int, float, float], None]  # stage, time steps of the attempt so far, settlement, reaction


@dataclass
class Protocol:
    """One attempt with a model: `run` carries out both stages, and YADE calls `watch` at every recorded step.

    Attributes
    ----------
    case, settings : Case, Settings
        The case that runs, and every setting of the run.
    model, record : Model, Record
        Bodies of the case in YADE; rows and poses so far.
    progress : callable
        Receives stage, time steps of the attempt so far, settlement and reaction of each row.
    near : NearFaces or None
        Faces near the spheres: the attempt ends where a sphere may touch one. None where YADE looks for new contacts, or none can form.
    pace : float
        Speed of the attempt over that of the attempt that counts.
    met_face : bool
        Whether the attempt ended because a sphere may have touched such a face.
    dropped_steps : int
        Time steps of the earlier attempt that this one repeats.
    status, message : Status or None, str
        Status of the run, None while it runs; reason for its end, as a phrase.
    asked_settlement : float
        Settlement imposed so far, m or rad.
    error : BaseException or None
        Exception raised in `watch`.
    steps : int
        Time steps, once the run has ended.
    """

    case: Case
    settings: Settings
    model: Model
    record: Record
    progress: Progress
    near: NearFaces | None = None
    pace: float = 1.0
    met_face: bool = False
    dropped_steps: int = 0
    status: Status | None = None
    message: str = ""
    asked_settlement: float = 0.0
    error: BaseException | None = None
    steps: int = 0
    _servo: Servo | None = None
    _damper: SwingDamper | None = None
    _stage: int = GRAVITY
    _speed: float = 0.0
    _start_time: float = 0.0
    _last_time: float = 0.0
    _end_time: float = 0.0
    _end_step: int = 0
    _next_pose: float = 0.0
    _origin: float = 0.0
    _at_rest: int = 0
    _began: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        """Begin the search for the plateau."""
        self.search = PlateauSearch(self.case, self.settings, self.record)

    @property
    def plateau(self) -> Plateau:
        """The last fit; its values are NaN before the first one."""
        return self.search.plateau

    @property
    def outcome(self) -> Outcome:
        """Reaction of the plateau with the parts of its uncertainty; NaN without a plateau."""
        return self.search.outcome

    def run(self) -> None:
        """Run both stages; `status`, `message` and `plateau` then describe the end. Re-raises an exception of `watch`."""
        settings, dt = self.settings, self.settings.time_step
        if settings.wedging > 0.0:
            self._wedge()
        longest = max(math.ceil(settings.gravity_time / dt), ROWS_AT_REST)  # a shorter stage would have too few rows
        self._start_time = Omega().time
        self._load(0.0)
        self._advance(longest, max(1, longest // GRAVITY_ROWS))
        if self.status is None and self._at_rest < ROWS_AT_REST:
            last = self.record.rows[-1]
            motion = f"unbalanced force {last.unbalanced:.2g} of a block's weight, kinetic energy {last.kinetic_energy:.2g} J"
            self._end(Status.FAILED, f"not at rest under gravity after {settings.gravity_time:.3g} s: {motion}")
        self.record.store_pose()
        if self.status is None:
            self._settle()
        if self.status is None:
            self._judge()
        self.steps = max(Omega().iter, self._end_step)
        if self.case.recording == "plateau":
            self.record.keep_plateau(self.plateau.start)

    def _wedge(self) -> None:
        """Close the joints by a motion against the settlement, before gravity acts: weights alone may not create the necessary thrust."""
        settings = self.settings
        steps = math.ceil(settings.wedging / settings.speed / settings.time_step)
        set_loads(self.case, self.model, 0.0)
        set_speed(self.case, self.model.drive, -settings.speed)
        self._advance(steps, steps + 1)
        set_speed(self.case, self.model.drive, 0.0)
        self.asked_settlement = -settings.speed * steps * settings.time_step

    def _settle(self) -> None:
        settings, dt = self.settings, self.settings.settling_step
        self.model.integrator.damping, Omega().dt = 0.0, dt
        self._stage, self._start_time = SETTLEMENT, max(Omega().time, self._end_time)
        if settings.swing_damping > 0.0:
            self._damper = swing_damper(self.case, settings, self.model.inertia, self.record.states)
            self.model.calm.iterPeriod, self.model.calm.dead = self._damper.every, False
        self._last_time = self._start_time
        self._next_pose = FIRST_POSE * settings.max_travel / settings.poses / max(settings.stiffening, 1.0)
        self._origin = self.asked_settlement
        every = max(1, int(settings.max_travel / settings.speed / settings.record_rows / dt))
        full_time = (settings.max_travel + settings.wedging) / settings.speed + 0.5 * settings.ramp_time
        if self.case.live is None:
            self._set_speed(every * dt)
        else:
            self._servo = servo_of(self.case, settings)
            self.record.start_load()
            self._servo.start(self.record)
            assert not isinstance(self.model.drive, list)  # a list of engines would move supports
            self.model.drive.iterPeriod, self.model.drive.dead = self._servo.every, False
            full_time += self._servo.loading_time()
        self._advance(math.ceil(full_time / dt), every)
        if self._servo is None and not self.record.is_cut:
            self.asked_settlement += self._speed * (max(Omega().time, self._end_time) - self._last_time)
        if self.record.poses[-1].settlement < self.record.settlement():
            self.record.store_pose()

    def pull(self) -> None:
        """Set the multiplier of the live load. Runs in YADE's thread, as `watch` does."""
        if self._servo is not None:
            self._guarded(self._pull)

    def _pull(self) -> None:
        assert self._servo is not None
        set_loads(self.case, self.model, multiplier=self._servo.measured(Omega().time - self._start_time, self.record))

    def calm(self) -> None:
        """Damp the swing of the blocks. Runs in YADE's thread, as `watch` does."""
        if self._damper is not None:
            self._guarded(self._damper.damp)

    def _guarded(self, act: Callable[[], None]) -> None:
        """Call a function in YADE's thread: an exception is stored, and the stage ends."""
        if self.error is None:
            try:
                act()
            except BaseException as error:
                self.error = error
                self._pause()

    def _travelled(self, row: Row) -> float:
        """Return the motion that the travel limits: of the supports, or under a live load of the block that moved farthest."""
        return row.settlement if self.case.live is None else row.displacement

    def _advance(self, steps: int, every: int) -> None:
        self.model.watch.iterPeriod = every
        Omega().run(steps, True)
        if self.error is not None:
            raise self.error

    def watch(self) -> None:
        """Record a row and decide whether to go on. Runs in YADE's thread: `run` raises an exception that occurs here."""
        if self.status is None:
            self._guarded(self._watch)

    def _watch(self) -> None:
        row = self.record.read_row(self._stage, self._damper.taken if self._damper is not None else 0.0)
        self._stop_if_lost(row)
        if self.status is None:
            (self._watch_gravity if self._stage == GRAVITY else self._watch_settlement)(row)
        if self.status is not None:
            self._pause()

    def _pause(self) -> None:
        """End the stage with this step. Time and step number are computed, because YADE's thread may not have counted this step yet."""
        self._end_time, self._end_step = Omega().time + Omega().dt, Omega().iter + 1
        Omega().pause()

    def _stop_if_lost(self, row: Row) -> None:
        loss = loss_of(self.case, self.settings, row, self._began)
        has_fallen = loss is not None and loss[0] is Status.COLLAPSED  # a face that is not listed might have caught the block
        if (has_fallen or len(self.record.rows) % ROWS_BETWEEN_LOOKS == 0) and self._meets_face():
            return
        if loss is not None:
            self._end(*loss)

    def _meets_face(self) -> bool:
        """Whether a sphere may have touched a face that the case does not list; if so, the run ends."""
        if self.near is not None and self.near.are_met(*self.record.motion()):
            self.met_face = True
            place = settlement_words(self.case, self.record.settlement())
            self._end(Status.FAILED, f"a block comes to a face that it did not touch, at {place}")
        return self.met_face

    def _load(self, elapsed: float) -> bool:
        """Set the weights `elapsed` seconds after the start of their ramp; return whether they still grow."""
        duration = self.settings.gravity_ramp
        set_loads(self.case, self.model, ramp(elapsed, duration))
        return elapsed < duration

    def _watch_gravity(self, row: Row) -> None:
        loading = self._load(row.time - self._start_time)
        rests = not loading and row.unbalanced < self.settings.rest_unbalanced and row.kinetic_energy < self.settings.rest_energy
        self._at_rest = self._at_rest + 1 if rests else 0
        self.progress("gravity", Omega().iter, 0.0, row.reaction)
        if self._at_rest >= ROWS_AT_REST:
            self._pause()

    def _watch_settlement(self, row: Row) -> None:
        settings, travelled = self.settings, self._travelled(row)
        if self._servo is None:
            self.asked_settlement += self._speed * (row.time - self._last_time)
            self._last_time = row.time
            if self._speed < settings.speed:
                self._set_speed(row.time - self._start_time + 0.5 * self.model.watch.iterPeriod * Omega().dt)
        else:
            self.asked_settlement = self._servo.pulled(row.time - self._start_time)[0]
        is_later = row.settlement > self.record.poses[-1].settlement  # a lifted support begins below 0
        if is_later and travelled - self._origin >= self._next_pose:
            self.record.store_pose()
            is_early = travelled < settings.plateau_travel
            apart = settings.plateau_travel / EARLY_POSES if is_early else LATE_POSES * (travelled - self._origin)
            self._next_pose += min(self._next_pose, apart, settings.max_travel / settings.poses)
        self.progress("settlement", Omega().iter, row.settlement, row.reaction)
        if self._servo is not None and travelled >= settings.max_travel:
            self._judge()
        elif travelled >= settings.plateau_travel and len(self.record.rows) % ROWS_BETWEEN_FITS == 0:
            may_end = self.search.look(self.asked_settlement)
            # A damped swing dies away as the run goes on. So only a jump ends such a run early; its record so far then decides.
            is_calmed = settings.swing_damping > 0.0
            if self._is_restless and not is_calmed:
                self._end_rattling()
            elif may_end or (self._is_restless and jumps(self.case, settings, self.record)):
                self._judge()

    @property
    def may_damp(self) -> bool:
        """Whether an attempt with more damping may follow."""
        return self.settings.damping_ratio < CRITICAL and not {"damping_ratio", "normal_damping"} & set(self.case.overrides)

    @property
    def _is_restless(self) -> bool:
        return is_restless(self.case, self.settings, self.record, self.may_damp, self.pace)

    def _set_speed(self, elapsed: float) -> None:
        """Set the supports' speed `elapsed` seconds after the start, on a cosine ramp from rest to full speed."""
        self._speed = ramp(elapsed, self.settings.ramp_time) * self.settings.speed
        set_speed(self.case, self.model.drive, self._speed)

    def _judge(self) -> None:
        """End the run: with a plateau, or without one."""
        if self._meets_face():
            return
        status, message, self.asked_settlement = self.search.ended(self.asked_settlement)
        # Rattling counts up to the plateau: rows after a plateau that the reaction has left are cut off.
        if self._is_restless:
            self._end_rattling()
        else:
            self._end(status, message)

    def _end_rattling(self) -> None:
        self._end(Status.NO_PLATEAU, f"blocks rattle at {settlement_words(self.case, self.record.settlement())}")

    def _end(self, status: Status, message: str) -> None:
        if status in (Status.COLLAPSED, Status.TIMEOUT, Status.FAILED):
            self.search.plateau = plateau.NONE
        self.status, self.message = status, message
