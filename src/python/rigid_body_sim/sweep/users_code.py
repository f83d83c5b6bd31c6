# SPDX-License-Identifier: BSD-3-Clause
"""Functions of the user's own files. Their text travels with the plan, so a worker needs no copy of the file."""
import functools
import linecache
import os
import traceback

from .tree import Refused


def checked(given, folder):
    """'FILE.py:FUNCTION' with the text of the file."""
    file, _, function = given.rpartition(':') if isinstance(given, str) else ('', '', '')
    if not file or not function.isidentifier():
        raise Refused(f'{given!r} (allowed: FILE.py:FUNCTION)')
    path = os.path.join(folder, file)
    try:
        with open(path, encoding='utf-8') as source:
            text = source.read()
    except (OSError, UnicodeDecodeError) as error:
        raise Refused(f'{path} cannot be read: {getattr(error, "strerror", None) or error}')
    code = {'path': path, 'function': function, 'text': text}
    try:
        loaded(path, function, text)
    except Exception as error:  # whatever the user's file raises
        raise Refused(f'{path}: {said(error, path)}')
    return code


@functools.lru_cache(maxsize=64)
def loaded(path, function, text):
    """The function. A traceback shows its lines, also where there is no such file."""
    linecache.cache[path] = (len(text), None, text.splitlines(True), path)
    names = {'__name__': os.path.splitext(os.path.basename(path))[0], '__file__': path}
    exec(compile(text, path, 'exec'), names)
    if not callable(names.get(function)):
        raise NameError(f"there is no function '{function}'")
    return names[function]


def said(error, path=None):
    """An exception in one line, with the last line of the user's file that it came from."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == path]
    if isinstance(error, SyntaxError):
        lines = [error.lineno]
    return f'{type(error).__name__}: {error}' + (f' ({os.path.basename(path)}, line {lines[-1]})' if path and lines else '')
