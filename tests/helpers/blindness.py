"""Finds functions that call limit analysis while they hold YADE's result, from the names and annotations in their sources."""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

ANSWERS = {"LimitAnalysis", "Answers", "Answer", "CoulombSolution", "EquilibriumPath", "Solution"}  # returned by a prediction
READERS = {"read_case"}  # functions that return a stored answer
RUNS = {"Run", "Results"}  # types that hold YADE's result
RESTORES = "comparison.workflow.restored_effects"  # the only module that may call limit analysis after a run
DOOR = f"{RESTORES}:restore"  # its only function that other modules may call
Place = tuple[int, int]  # line and column
Use = tuple[Place, str]  # place where a function names another function, and the other's key: "module:function" or "la_core:function"


@dataclass(frozen=True)
class Function:
    """A function or method: its key ("module:function"), its source, and the class that it belongs to ("" for none)."""

    key: str
    node: ast.FunctionDef
    owner: str

    @property
    def taken(self) -> set[str]:
        """Names of its class and of the types of its arguments."""
        given = self.node.args
        every = (*given.posonlyargs, *given.args, *given.kwonlyargs, *filter(None, (given.vararg, given.kwarg)))
        return {self.owner}.union(*(named(one.annotation) for one in every))

    @property
    def returned(self) -> set[str]:
        """Names of the types that it returns."""
        return named(self.node.returns)


def named(annotation: ast.AST | None) -> set[str]:
    """Return every name in an annotation, including names in quotes."""
    found: set[str] = set()
    for node in ast.walk(annotation) if annotation is not None else ():
        if isinstance(node, ast.Name):
            found.add(node.id)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            found |= named(ast.parse(node.value, mode="eval"))
    return found


def functions(module: str, source: str) -> Iterator[Function]:
    """Yield the functions and methods of a module. Its other statements form one more function, without a name."""
    loose: list[ast.stmt] = []
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef):
            yield Function(f"{module}:{node.name}", node, "")
        elif isinstance(node, ast.ClassDef):
            methods = (one for one in node.body if isinstance(one, ast.FunctionDef))
            yield from (Function(f"{module}:{node.name}.{one.name}", one, node.name) for one in methods)
        else:
            loose.append(node)
    nothing = ast.arguments(posonlyargs=[], args=[], kwonlyargs=[], kw_defaults=[], defaults=[])
    yield Function(f"{module}:", ast.FunctionDef(name="", args=nothing, body=loose, decorator_list=[]), "")


def predictors(sources: Mapping[str, str]) -> set[str]:
    """Return the keys of the public functions of limit analysis that compute an answer. sources: texts of la_core, by module."""
    every = [function for module, source in sources.items() for function in functions(module, source) if not function.owner]
    names = {function.node.name for function in every if function.returned & ANSWERS}
    return {f"la_core:{name}" for name in names - READERS if not name.startswith("_")}


class House:
    """The modules of `comparison`: the functions that each function uses, and the place where it gets YADE's result.

    sources: texts by module. predicting: keys of the functions of limit analysis that compute an answer.
    """

    def __init__(self, sources: Mapping[str, str], predicting: set[str]) -> None:
        every = [(module, one) for module, source in sources.items() for one in functions(module, source)]
        homes: dict[str, list[str]] = {}
        for _, one in every:
            homes.setdefault(one.key.partition(":")[2], []).append(one.key)
        imports = {module: dict(imported(source)) for module, source in sources.items()}
        self.functions = {one.key: one for _, one in every}
        self.uses = {one.key: sorted(used(module, one, imports[module], homes)) for module, one in every}
        self.carriers = carriers(sources)
        self.predicting = self._predicting(predicting)

    def _predicting(self, direct: set[str]) -> set[str]:
        """Return the keys of all functions that compute an answer, themselves or through others. Calls of DOOR do not count."""
        found = set(direct)
        while more := {key for key, uses in self.uses.items() if any(use in found for _, use in uses)} - found - {DOOR}:
            found |= more
        return found

    def offences(self) -> list[str]:
        """Return the uses of limit analysis by functions that already hold YADE's result."""
        found = []
        for key, uses in self.uses.items():
            seen = None if key.startswith(f"{RESTORES}:") else self.first_sight(key)
            late = [(place, use) for place, use in uses if seen is not None and place > seen and use in self.predicting]
            found += [f"{key} uses {use} in line {place[0]}, with YADE's result in hand" for place, use in late]
        return found

    def first_sight(self, key: str) -> Place | None:
        """Return the place where a function gets YADE's result, or None: its start, a call, or the start of the loop around the call."""
        function = self.functions[key]
        if function.taken & self.carriers:
            return (0, 0)
        calls = [place for place, use in self.uses[key] if use in self.functions and self.functions[use].returned & self.carriers]
        loops = [node for node in ast.walk(function.node) if isinstance(node, ast.For | ast.While)]
        around = [place_of(loop) for loop in loops if {place_of(node) for one in loop.body for node in ast.walk(one)} & set(calls)]
        return min((*calls, *around), default=None)


def carriers(sources: Mapping[str, str]) -> set[str]:
    """Return the names of the classes that hold YADE's result, in a field or in a field of a field."""
    classes = [node for source in sources.values() for node in ast.parse(source).body if isinstance(node, ast.ClassDef)]
    held = {
        node.name: set[str]().union(*(named(one.annotation) for one in node.body if isinstance(one, ast.AnnAssign))) for node in classes
    }
    found = set(RUNS)
    while more := {name for name, types in held.items() if types & found} - found:
        found |= more
    return found


def imported(source: str) -> Iterator[tuple[str, str]]:
    """Yield every imported name with its full dotted name."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            yield from ((alias.asname or alias.name, f"{node.module}.{alias.name}") for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.asname, alias.name) if alias.asname else (alias.name.split(".")[0],) * 2 for alias in node.names)


def used(module: str, function: Function, imports: Mapping[str, str], homes: Mapping[str, list[str]]) -> Iterator[Use]:
    """Yield the functions that a function names, called or not: imported names, names in imported modules, functions of its own module."""
    own = {node.id for node in ast.walk(function.node) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    own |= {node.arg for node in ast.walk(function.node) if isinstance(node, ast.arg)}
    for node in ast.walk(function.node):
        first, *rest = dotted(node)
        if not first or first in own:
            continue
        home, _, name = ".".join((imports.get(first, f"{module}.{first}"), *rest)).rpartition(".")
        if home.startswith("la_core"):
            yield place_of(node), f"la_core:{name}"
        else:  # a package's `__init__` exports functions of its modules
            yield from ((place_of(node), key) for key in homes.get(name, ()) if key.startswith(home))


def dotted(node: ast.AST) -> list[str]:
    """Return the parts of a dotted expression that begins with a name, and one empty part for any other expression."""
    if isinstance(node, ast.Name):
        return [node.id]
    if isinstance(node, ast.Attribute):
        before = dotted(node.value)
        return [*before, node.attr] if before[0] else before
    return [""]


def place_of(node: ast.AST) -> Place:
    return getattr(node, "lineno", 0), getattr(node, "col_offset", 0)
