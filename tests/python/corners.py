"""Model Exchange under other people's integrators, through surface, seabed and the limits of ballast and moving mass:
every method, tolerance and output interval.

    cargo xtask integrators                         packs the archives, flies all of them and prints the table
    python tests/python/corners.py ARCHIVE...       the same with archives that are there

Two flights at a time. Euler's method in a dive ends the table of each archive.

An importer of its own drives scipy's methods with events as the standards have them; CVODE is FMPy's.
"""

import contextlib
import ctypes
import functools
import io
import multiprocessing
import shutil
import sys
import tempfile
import time as clock
from dataclasses import dataclass, field
from unittest import mock

import numpy as np
from fmpy import sundials
from fmpy.sundials.libraries import sundials_cvode
from fmpy import extract, instantiate_fmu, read_model_description, simulate_fmu
from scipy.integrate import solve_ivp

METHODS = ["CVODE", "LSODA", "BDF", "Radau"]
TOLERANCES = [1e-4, 1e-6, 1e-8, 1e-10]
INTERVALS = [1.0, 10.0, 60.0, 600.0]
# An event that is followed by another one sooner than this, so many times, goes round in a circle.
AT_ONCE_S, MOST_AT_ONCE = 1e-9, 50


@dataclass(frozen=True)
class Mission:
    """Start values, and inputs that jump at times."""

    start: dict[str, float]
    # Time, s, and the inputs from then on.
    legs: list[tuple[float, dict[str, float]]]
    stop: float
    # Enumerations.
    choices: dict[str, int] = field(default_factory=dict)

    def at(self, time: float) -> dict[str, float]:
        held = {}
        for begin, inputs in self.legs:
            if begin <= time:
                held |= inputs
        return held

    def signals(self) -> np.ndarray:
        """The inputs as FMPy takes them: a time stands twice where they jump."""
        names = sorted({name for _, inputs in self.legs for name in inputs})
        rows = []
        for number, (begin, _) in enumerate(self.legs):
            if number:
                before = self.at(np.nextafter(begin, 0))
                rows.append((begin, *(before[name] for name in names)))
            held = self.at(begin)
            rows.append((begin, *(held[name] for name in names)))
        held = self.at(self.stop)
        rows.append((self.stop, *(held[name] for name in names)))
        return np.array(rows, dtype=[("time", np.float64), *((name, np.float64) for name in names)])


DOWN = {"ballast_command_m3": -4.6e-5, "moving_mass_command_m": 0.02}
UP = {"ballast_command_m3": 4.6e-5, "moving_mass_command_m": -0.02}
# Beyond what the actuators reach.
EMPTY = {"ballast_command_m3": 5e-4, "moving_mass_command_m": -0.2}
MISSIONS = {
    # Onto the seabed, a rest there, up to the surface, a stay there with all the ballast out, and down again to mid-water.
    "seabed and surface": Mission({"seabed_depth_m": 60.0}, [(0, DOWN), (1200, UP), (2000, EMPTY), (2600, DOWN)], 3000),
}
# From one steady glide to the other in mid-water: neither surface nor seabed is met.
LEG_CHANGE = Mission({}, [(0, DOWN), (600, UP)], 1000)
RAW = {"u1_N": 0.0, "u3_N": 0.0}
RAW_MISSIONS = {
    # The ballast runs into both of its limits, the moving mass is pushed into its foremost and aftmost one.
    "limits": Mission(
        {"ballast_min_m3": -1e-4, "ballast_max_m3": 1e-4, "moving_mass_min_m": -0.03, "moving_mass_max_m": 0.03},
        [
            (0, {"u1_N": 0.0, "u3_N": 0.0, "u4_kg_s": 0.0}),
            (20, {"u4_kg_s": 0.005}),
            (120, {"u1_N": 0.5}),
            (180, {"u1_N": 0.0, "u4_kg_s": -0.005}),
            (300, {"u1_N": -0.5}),
            (360, {"u1_N": 0.0, "u4_kg_s": 0.005}),
        ],
        600,
        {"actuation": 2},
    ),
}


def missions(description) -> dict[str, Mission]:
    names = {variable.name for variable in description.modelVariables}
    return MISSIONS | (RAW_MISSIONS if "u4_kg_s" in names else {})


@dataclass
class Result:
    """Where a flight ended, and what it took."""

    states: np.ndarray
    events: int
    evaluations: int
    seconds: float


def states_of(description) -> list:
    """The continuous states in the order of every call: that of their derivatives in the model's structure."""
    return [rate.variable.derivative for rate in description.derivatives]


class Importer:
    """Model Exchange through FMPy's functions."""

    def __init__(self, folder, mission: Mission):
        self.description = read_model_description(folder)
        self.is_3 = self.description.fmiVersion.startswith("3")
        self.fmu = instantiate_fmu(unzipdir=folder, model_description=self.description, fmi_type="ModelExchange")
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        self.n = self.description.numberOfContinuousStates
        self.n_events = self.description.numberOfEventIndicators
        self.derivatives = [rate.variable.valueReference for rate in self.description.derivatives]
        self.state_references = [state.valueReference for state in states_of(self.description)]
        self.evaluations = self.events = 0
        for name, value in mission.choices.items():
            (self.fmu.setInt64 if self.is_3 else self.fmu.setInteger)([self.reference[name]], [value])
        if not self.is_3:
            self.fmu.setupExperiment(startTime=0.0)
        self.set(mission.start)
        self.set(mission.at(0.0))
        self.fmu.enterInitializationMode(**({"startTime": 0.0} if self.is_3 else {}))
        self.fmu.exitInitializationMode()
        self.next_event = self.update()
        self.nominals = self.read(self.fmu.getNominalsOfContinuousStates)

    def set(self, values):
        if values:
            write = self.fmu.setFloat64 if self.is_3 else self.fmu.setReal
            write([self.reference[name] for name in values], list(values.values()))

    def read(self, function, n=None):
        values = np.zeros(self.n if n is None else n)
        function(np.ctypeslib.as_ctypes(values), len(values))
        return values

    def states(self):
        return self.read(self.fmu.getContinuousStates)

    def go_to(self, time, states):
        self.fmu.setTime(time)
        states = np.ascontiguousarray(states)
        self.fmu.setContinuousStates(np.ctypeslib.as_ctypes(states), self.n)

    def rates(self, time, states):
        self.evaluations += 1
        self.go_to(time, states)
        return self.read(self.fmu.getContinuousStateDerivatives if self.is_3 else self.fmu.getDerivatives)

    def jacobian(self, time, states):
        """From the FMU's own derivatives. (scipy's differences for BDF and Radau let the step of a state that nothing depends
        on grow tenfold each time, until it is infinite: the energy, at 1e-10.)"""
        self.go_to(time, states)
        column = self.fmu.getDirectionalDerivative
        return np.array([column(self.derivatives, [known], [1.0]) for known in self.state_references]).T

    def indicator(self, number):
        def value(time, states):
            self.go_to(time, states)
            return self.read(self.fmu.getEventIndicators, self.n_events)[number]

        value.terminal = True
        return value

    def update(self):
        """Event Mode until nothing changes any more. Returns when time alone brings the next event."""
        needed = True
        while needed:
            info = self.fmu.updateDiscreteStates() if self.is_3 else self.fmu.newDiscreteStates()
            needed, terminate, _, _, defined, next_event = info
            assert not terminate
        self.fmu.enterContinuousTimeMode()
        return next_event if defined else np.inf

    def event(self, inputs=None):
        self.events += 1
        self.fmu.enterEventMode()
        self.set(inputs)
        self.next_event = self.update()

    def free(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def fly_by_scipy(folder, mission: Mission, method: str, tolerance: float, interval: float) -> Result:
    """From output to output and from event to event by one of scipy's methods, which begins anew at each event."""
    importer = Importer(folder, mission)
    begun = clock.perf_counter()
    indicators = [importer.indicator(number) for number in range(importer.n_events)]
    jumps = [begin for begin, _ in mission.legs if begin > 0]
    time, at_once, step = 0.0, 0, None
    while time < mission.stop - 1e-9:
        end = min([mission.stop, importer.next_event, *(jump for jump in jumps if jump > time)])
        points = np.arange(np.floor(time / interval) + 1, np.ceil(end / interval)) * interval
        solution = solve_ivp(
            importer.rates,
            (time, end),
            importer.states(),
            method=method,
            rtol=tolerance,
            atol=tolerance * importer.nominals,
            t_eval=np.append(points[(points > time) & (points < end)], end),
            events=indicators,
            **({} if method == "LSODA" else {"jac": importer.jacobian}),
        )
        if solution.status < 0:
            raise RuntimeError(f"at {time} s: {solution.message}")
        before = time
        if solution.status == 1:
            fired = next(i for i, times in enumerate(solution.t_events) if len(times))
            time, states = solution.t_events[fired][-1], solution.y_events[fired][-1]
        else:
            time, states = end, solution.y[:, -1]
        importer.go_to(time, states)
        importer.event(mission.at(time) if time in jumps else None)
        at_once = at_once + 1 if time - before < AT_ONCE_S else 0
        if at_once > MOST_AT_ONCE:
            raise RuntimeError(f"events follow each other without end at {time} s")
    result = Result(importer.states(), importer.events, importer.evaluations, clock.perf_counter() - begun)
    importer.free()
    return result


def fly_by_cvode(folder, mission: Mission, tolerance: float, interval: float, most_steps: int | None = None) -> Result:
    """As FMPy does it; `most_steps` instead of its 500 internal steps from one output to the next."""
    names = [state.name for state in states_of(read_model_description(folder))]
    begun = clock.perf_counter()
    with contextlib.ExitStack() as stack:
        if most_steps is not None:
            constructor = sundials.CVodeSolver.__init__
            patient = functools.partialmethod(constructor, maxNumSteps=most_steps)
            stack.enter_context(mock.patch.object(sundials.CVodeSolver, "__init__", patient))
        # FMPy warns of every input that the mission leaves at its start.
        stack.enter_context(contextlib.redirect_stdout(io.StringIO()))
        rows = simulate_by_cvode(folder, mission, tolerance, interval, names)
    on_grid = np.isclose(rows["time"] / interval, np.round(rows["time"] / interval))
    end = rows[-1]
    return Result(np.array([end[name] for name in names]), int((~on_grid).sum()), 0, clock.perf_counter() - begun)


def simulate_by_cvode(folder, mission: Mission, tolerance: float, interval: float, names: list[str]):
    return simulate_fmu(
        folder,
        fmi_type="ModelExchange",
        solver="CVode",
        stop_time=mission.stop,
        output_interval=interval,
        relative_tolerance=tolerance,
        start_values=mission.start | mission.at(0.0) | mission.choices,
        input=mission.signals(),
        output=names,
    )


def internal_steps(folder, mission: Mission, tolerance: float, interval: float) -> dict[float, int]:
    """CVODE's internal steps in each of FMPy's calls, by the time at which the call ended. FMPy allows 500 in each."""
    most: dict[float, int] = {}
    step = sundials.CVodeSolver.step

    def counted(solver, time, next_time):
        before = steps_of(solver)
        found, roots, reached = step(solver, time, next_time)
        most[reached] = max(steps_of(solver) - before, most.get(reached, 0))
        return found, roots, reached

    with mock.patch.object(sundials.CVodeSolver, "step", counted):
        fly_by_cvode(folder, mission, tolerance, interval, 100_000)
    return most


def steps_of(solver: sundials.CVodeSolver) -> int:
    count = ctypes.c_long(0)
    function = sundials_cvode.CVodeGetNumSteps
    function.argtypes = [ctypes.c_void_p, ctypes.POINTER(ctypes.c_long)]
    assert function(solver.cvode_mem, ctypes.byref(count)) == 0
    return count.value


def fly(folder, mission: Mission, method: str, tolerance: float, interval: float) -> Result:
    if method == "CVODE":
        return fly_by_cvode(folder, mission, tolerance, interval)
    return fly_by_scipy(folder, mission, method, tolerance, interval)


EULER_STEP_S = 0.05
DIVE = {"moving_mass_command_m": 0.03, "ballast_command_m3": -8e-5}


def euler_in_a_dive(folder) -> dict[str, float]:
    """Largest distance of a dive of 600 s by Euler's method from the library's own, relative to each output's largest value."""
    # FMPy takes the output interval as the step of Euler's method.
    options = {"stop_time": 600, "step_size": EULER_STEP_S, "output_interval": EULER_STEP_S, "start_values": DIVE}
    options["output"] = ["depth_m", "pitch_rad", "speed_m_s"]
    coarse = simulate_fmu(folder, fmi_type="ModelExchange", solver="Euler", **options)
    own = simulate_fmu(folder, relative_tolerance=1e-9, **options)
    # Model Exchange has rows at events, too.
    times, first = np.unique(coarse["time"], return_index=True)
    distance = {}
    for name in options["output"]:
        apart = np.interp(own["time"], times, coarse[name][first]) - own[name]
        distance[name] = float(np.abs(apart).max() / np.abs(own[name]).max())
    return distance


def corner(work) -> tuple[bool, str]:
    """Flies one corner; whether it failed, and its row."""
    folder, name, method, tolerance, interval = work
    description = read_model_description(folder)
    mission = missions(description)[name]
    head = f"{name:20} {method:6} {tolerance:9.0e} {interval:8.0f}"
    remark = ""
    try:
        try:
            result = fly(folder, mission, method, tolerance, interval)
        except RuntimeError as error:
            if "mxstep" not in str(error):
                raise
            remark = "  more than FMPy's 500 internal steps"
            result = fly_by_cvode(folder, mission, tolerance, interval, 100_000)
    except Exception as error:
        return True, f"{head} FAILED: {error}"
    depth = result.states[depth_of(description)]
    return False, f"{head} {depth:9.4f} {result.events:6} {result.evaluations:8} {result.seconds:6.1f}{remark}"


def table(archive: str, methods=METHODS, tolerances=TOLERANCES, intervals=INTERVALS) -> int:
    """Flies every corner and prints a row for each; returns how many failed."""
    folder = tempfile.mkdtemp()
    extract(archive, unzipdir=folder)
    description = read_model_description(folder)
    print(f"\n{description.modelName}, FMI {description.fmiVersion}")
    print(f"{'mission':20} {'method':6} {'tolerance':>9} {'interval':>8} {'depth m':>9} {'events':>6} {'rates':>8} {'s':>6}")
    work = [
        (folder, name, method, tolerance, interval)
        for name in missions(description)
        for method in methods
        for tolerance in tolerances
        # scipy's methods interpolate outputs: they take the same steps for all intervals.
        for interval in (intervals if method == "CVODE" else (intervals[0], intervals[-1]))
    ]
    failed = 0
    # A process of its own for each flight: an FMU that ended the process would end one row.
    with multiprocessing.get_context("spawn").Pool(2, maxtasksperchild=1) as pool:
        for has_failed, row in pool.imap(corner, work):
            failed += has_failed
            print(row, flush=True)
    with contextlib.redirect_stdout(io.StringIO()):
        euler = euler_in_a_dive(folder)
    print("Euler, 0.05 s, 600 s:", ", ".join(f"{name} {apart:.1e}" for name, apart in euler.items()), flush=True)
    failed += not max(euler.values()) < 1e-2
    shutil.rmtree(folder)
    return failed


def depth_of(description) -> int:
    """The place of the depth among the states."""
    return [state.name for state in states_of(description)].index("depth_m")


if __name__ == "__main__":
    failures = sum(table(archive) for archive in sys.argv[1:])
    sys.exit(f"{failures} flights failed" if failures else 0)
