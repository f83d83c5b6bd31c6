# SPDX-License-Identifier: BSD-3-Clause
"""Functions of the user's own files. Their text travels with the plan, so a worker needs no copy of the file."""
import functools
import linecache
import os
import signal
import sys
import traceback
import types

import numpy

from .tree import Refused


class Overtime(BaseException):
    """A run has taken longer than it may. A user's `except Exception` does not catch it."""


def checked(given, folder):
    """'FILE.py:FUNCTION' with the text of the file."""
    file, _, function = given.rpartition(':') if isinstance(given, str) else ('', '', '')
    if not file or not function.isidentifier():
        raise Refused(f'{given!r} (allowed: FILE.py:FUNCTION)')
    path = os.path.join(folder, file)
    try:
        with open(path, encoding='utf-8') as source:
            text = source.read()
    except (OSError, ValueError) as error:  # such as a path with a NUL in it
        raise Refused(f'{path} cannot be read: {getattr(error, "strerror", None) or error}')
    code = {'path': path, 'function': function, 'text': text}
    try:
        Files().function(**code)
    except Exception as error:  # whatever the user's file raises
        raise Refused(f'{path}: {said(error, code)}')
    return code


class Files:
    """The files of a run. Each is executed once, at the first of its functions, so that those share its globals; the next run
    finds them as they are written, whatever worker makes it."""

    def __init__(self):
        self.names = {}

    def function(self, path, function, text):
        """One of the file; called, it raises an Exception or Overtime, whatever the user's code raises."""
        if (path, text) not in self.names:
            module = types.ModuleType('sweep_' + os.path.splitext(os.path.basename(path))[0])
            module.__file__ = path
            sys.modules[module.__name__] = module  # where dataclasses look their own up
            contained(exec, compiled(path, text), module.__dict__)
            self.names[path, text] = module.__dict__
        found = self.names[path, text].get(function)
        if not callable(found):
            raise NameError(f"there is no function '{function}'")
        return functools.partial(contained, found)


@functools.lru_cache(maxsize=64)
def compiled(path, text):
    """A traceback shows its lines, also where there is no such file."""
    linecache.cache[path] = (len(text), None, text.splitlines(True), path)
    return compile(text, path, 'exec')


def contained(function, *arguments):
    """Calls a user's function. One that would leave the program, as sys.exit() does, has failed. Ctrl-C passes, where it is not
    ignored as in workers."""
    try:
        return function(*arguments)
    except (Exception, Overtime):
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
            raise
        raise RuntimeError(f'it raised {type(error).__name__}: {error}').with_traceback(error.__traceback__)


def numbers(value):
    """What a metric is: a number or an array of them. Raises TypeError for all else, which NumPy might take for NaN."""
    found = numpy.asarray(value)
    if found.dtype.kind == 'O' and all(type(entry) in (int, float) for entry in found.flat):  # such as 10**20
        found = found.astype(float)
    if found.dtype.kind not in 'biuf':
        raise TypeError(f'{value!r:.60} is neither a number nor an array of numbers')
    return found.astype(float)


def said(error, code=None):
    """An exception in words, with the last line of the user's file that it came from, where `code` is what checked() gives."""
    path = code['path'] if isinstance(code, dict) and 'text' in code else None
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == path]
    if isinstance(error, SyntaxError):
        lines = [error.lineno]
    return f'{type(error).__name__}: {error}' + (f' ({os.path.basename(path)}, line {lines[-1]})' if path and lines else '')
