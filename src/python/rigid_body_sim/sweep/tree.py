# SPDX-License-Identifier: BSD-3-Clause
"""YAML as a tree that remembers its lines, and paths into a tree: bodies[ball].velocity[0]."""
import re

import yaml

LOADER = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)
# As the scene reader takes them: 'off' stays a word, and 1e-3 is a number.
WHOLE = re.compile(r'[-+]?[0-9]+')
HEXADECIMAL = re.compile(r'0x[0-9a-fA-F]+')
DECIMAL = re.compile(r'[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?')
MOST_DIGITS = 1000  # of a number: what is longer is text
WORDS = {'true': True, 'false': False, 'null': None, '~': None, '': None}
STEP_OF_PATH = re.compile(r'\.?([^.\[\]]+)|\[([^\[\]]+)\]')


class Refused(ValueError):
    """A mistake of the user. `faults` has a line of text for each: the place, what was found, what is allowed."""

    def __init__(self, *faults):
        super().__init__('\n'.join(faults))
        self.faults = list(faults)


def scalar(node):
    if node.style:  # quoted
        return node.value
    if node.value in WORDS:
        return WORDS[node.value]
    if WHOLE.fullmatch(node.value):
        return int(node.value) if len(node.value) <= MOST_DIGITS else node.value
    if HEXADECIMAL.fullmatch(node.value) and len(node.value) <= MOST_DIGITS:
        return int(node.value, 16)
    return float(node.value) if DECIMAL.fullmatch(node.value) else node.value


def read(text, name):
    """The tree of a YAML text, and the line of each place in it by its path, a tuple of keys and indices."""
    lines = {}

    def build(node, path):
        lines[path] = node.start_mark.line + 1
        if isinstance(node, yaml.ScalarNode):
            return scalar(node)
        if isinstance(node, yaml.SequenceNode):
            return [build(child, path + (k,)) for k, child in enumerate(node.value)]
        tree = {}
        for key_node, child in node.value:
            place = f'{name}:{key_node.start_mark.line + 1}'
            if not isinstance(key_node, yaml.ScalarNode):
                raise Refused(f'{place}: a key that is a list or a mapping (allowed: a word)')
            key = key_node.value
            if key in tree:
                raise Refused(f'{place}: {key}; the key stands twice')
            tree[key] = build(child, path + (key,))
            lines[path + (key,)] = key_node.start_mark.line + 1
        return tree

    try:
        for event in yaml.parse(text, Loader=LOADER):
            if isinstance(event, yaml.AliasEvent):
                raise Refused(f'{name}:{event.start_mark.line + 1}: *{event.anchor}; aliases are not read')
        root = yaml.compose(text, Loader=LOADER)
        return (build(root, ()) if root else None), lines
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        quoted = '; within braces a path with [ ] stands in quotes' if re.search(r'\{[^}"\']*\w\[', text) else ''
        raise Refused(f'{name}:{line}: {error.problem or error}{quoted}')
    except (yaml.YAMLError, RecursionError) as error:
        raise Refused(f'{name}: {error}')


def split(path):
    """The steps of a path as a list of words and indices; a word in brackets is the name of a list's entry."""
    steps, end = [], 0
    while end < len(path):
        match = STEP_OF_PATH.match(path, end)
        if not match:
            break
        key, entry = match.groups()
        steps.append(key if key is not None else [int(entry) if WHOLE.fullmatch(entry) else entry])
        end = match.end()
    if end < len(path) or not steps or isinstance(steps[0], list):
        raise Refused(f"'{path}' is no path (allowed: keys and entries, such as bodies[ball].velocity[0])")
    return steps


def entry_of(entries, which, path):
    """Index of an entry of a list, by its number or its `name`."""
    if not isinstance(entries, list):
        raise Refused(f'{path}: [{which}] follows what is no list')
    if isinstance(which, int):
        if not 0 <= which < len(entries):
            raise Refused(f'{path}: [{which}] of a list of {len(entries)}')
        return which
    names = [entry.get('name') if isinstance(entry, dict) else None for entry in entries]
    if which not in names:
        known = ', '.join(str(name) for name in names if name) or 'none has a name'
        raise Refused(f"{path}: no entry is named '{which}' (there are: {known:.300})")
    return names.index(which)


def place_of(tree, path):
    """The keys and indices that a path leads by, as a tuple: equal for all spellings of one place. What the tree does not have
    stays as it is spelled."""
    place = []
    for step in split(path):
        key = step
        if isinstance(step, list):
            try:
                key = entry_of(tree, step[0], path)
            except Refused:
                key = step[0]
        place.append(key)
        if isinstance(tree, list):
            tree = tree[key] if isinstance(key, int) and 0 <= key < len(tree) else None
        else:
            tree = tree.get(key) if isinstance(tree, dict) else None
    return tuple(place)


def value_at(tree, path):
    """What is at a path of a tree."""
    for step in split(path):
        if isinstance(step, list):
            tree = tree[entry_of(tree, step[0], path)]
        elif isinstance(tree, dict) and step in tree:
            tree = tree[step]
        else:
            raise Refused(f"{path}: there is no key '{step}'")
    return tree


def replaced(tree, path, value):
    """A tree with another value at the path; what does not change is shared. A key may be new, an entry not."""
    def put(node, steps):
        if not steps:
            return value
        step, rest = steps[0], steps[1:]
        if isinstance(step, list):
            index = entry_of(node, step[0], path)
            return node[:index] + [put(node[index], rest)] + node[index + 1:]
        if node is None:
            node = {}
        if not isinstance(node, dict):
            raise Refused(f"{path}: '{step}' follows what has no keys ({node!r:.60})")
        if step not in node and rest and isinstance(rest[0], list):
            raise Refused(f"{path}: there is no list '{step}'")
        return {**node, step: put(node.get(step), rest)}

    return put(tree, split(path))
