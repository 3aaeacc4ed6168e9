"""From a kernel's text to machine code: compiled by llvmlite, kept on disk, called through ctypes without the GIL."""

import ctypes
import warnings
from collections.abc import Callable, Sequence
from functools import cache as memoised
from typing import Any

from numeric import cache
from numeric.families.family import Family
from numeric.question import Question

Run = Callable[..., None]
_loaded: dict[tuple[str, ...], Any] = {}
_kept: list[Any] = []  # engines own the code that ctypes calls; they must outlive it


@memoised
def _llvm() -> Any:
    """The library, or None when it is missing or cannot serve this machine."""
    try:
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
    except Exception as reason:  # any failure here means one thing: use NumPy
        warnings.warn(
            f"llvmlite cannot be used ({reason}); maps run on NumPy arrays, about 20 times slower", stacklevel=2
        )
        return None
    return llvm


@memoised
def _processor() -> tuple[str, str]:
    llvm = _llvm()
    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _target() -> Any:
    llvm = _llvm()
    name, features = _processor()
    return llvm.Target.from_default_triple().create_target_machine(cpu=name, features=features, opt=3)


def available() -> bool:
    """Can kernels be compiled here?"""
    return _llvm() is not None


def compiled(family: Family, identity: str, shape: Sequence[str], question: Question, width: int) -> Run | None:
    """The kernel as a function, from memory, from disk, or newly made; None when only NumPy is left.

    `identity` names the blueprint: everything the family's steps depend on besides this package's text.
    """
    llvm = _llvm()
    if llvm is None:
        return None
    key = (identity, family.name, question.text, str(width), ",".join(shape))
    if key not in _loaded:
        stamp = (*key, cache.sources("numeric"), _version(), *_processor())
        code = cache.read("kernel", *stamp)
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target())
        if code is None:
            from numeric.kernel import kernel_text

            code = object_code(kernel_text(family, shape, question, width))
            cache.write("kernel", *stamp, code)
        engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
        engine.finalize_object()
        pointer = ctypes.c_void_p
        number = ctypes.c_int64
        prototype = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, pointer, number, number, number, number)
        _kept.append(engine)
        _loaded[key] = prototype(engine.get_function_address("run"))
    return _loaded[key]  # type: ignore[no-any-return]


def optimised(text: str) -> Any:
    """The module after LLVM's passes."""
    llvm = _llvm()
    module = llvm.parse_assembly(text)
    module.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_unrolling = False
    passes = llvm.create_pass_builder(_target(), options).getModulePassManager()
    passes.run(module, llvm.create_pass_builder(_target(), options))
    return module


def object_code(text: str) -> bytes:
    """The object file for this machine."""
    return bytes(_target().emit_object(optimised(text)))


def assembly(text: str) -> str:
    """What the processor will run, for reading."""
    return str(_target().emit_assembly(optimised(text)))


def _version() -> str:
    import llvmlite

    return str(llvmlite.__version__)
