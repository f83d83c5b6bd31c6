# SPDX-License-Identifier: BSD-3-Clause
"""Random requests from the definitions of the messages alone, so that a new service is covered without a word.

A request is mostly sound, with a hostile field here and there: one that is hostile all over is refused for its first
field, and no other would ever be looked at.
"""
import os
import struct

import genpy
import roslib.message

FORMATS = {'bool': '<B', 'int8': '<b', 'uint8': '<B', 'byte': '<b', 'char': '<B', 'int16': '<h', 'uint16': '<H',
           'int32': '<i', 'uint32': '<I', 'int64': '<q', 'uint64': '<Q', 'float32': '<f', 'float64': '<d'}

HOSTILE_FLOATS = [float('nan'), float('inf'), -float('inf'), 1e308, -1e308, 5e-324, -5e-324, 2.2e-308, -0.0, -1.0, 1e-300,
                  1e155, 1e77, 1e19, 1e9, 1e6, 1e-6, 1e-12, 3.4e38, 1e16 + 2]
SOUND_FLOATS = [0.0, 0.0, 0.0, 0.1, 0.25, 0.5, 1.0, 1.0, 2.0, -0.5, 9.81]
TEXTS = [b'box', b'sphere', b'plane', b'capsule', b'cylinder', b'cone', b'hull', b'world', b'', b'',
         b'preview', b'interactive', b'accurate', b'reference', b'gravity', b'drag', b'collision', b'friction',
         b'impacts', b'rolling', b'restitution', b'gyroscopic', b'rotation', b'buoyancy', b'sleeping',
         b'playground', b'shapes', b'harbour']
HOSTILE_TEXTS = [b'\0', b'a\0b', b'\xff\xfe\x80', b'\xc3(', b'\xed\xa0\x80', b'x' * 65, b'y' * 100000, b'-x', b'/a', b'a//b',
                 b'../..', b'%s%n%x', b'\n', b'\x1b[2J', b'$(exit)', b'"', b"'", b'{', b'a b', 'пример'.encode(), b'1e5', b'nan',
                 b'~', b'.', b'!!python/object', b'package://', b'package://no_such_package/x.stl', b'package://rigid_body_sim/../..',
                 b'/dev/null', b'/dev/full', b'/proc/self/mem', b'/']

# Numbers for which the node would rightly work for minutes, namely how many steps it takes and how long it may measure; and
# the wall time of solves, which none here reaches, since runs that it cuts short rightly differ.
TAMED = {('TuneFidelity', 'max_solve_ms'): [0.0, 0.0, 1e6, 1e-7, -1.0, float('nan'), 1e308],
         ('Step', 'n'): [0, 1, 2, 3, 1000001, 4294967295],
         ('MeasureAccuracy', 'seconds'): [0.1, -1.0, float('nan'), float('inf'), 1e308],
         ('MeasureAccuracy', 'windows'): [1, 2, 4294967295],
         ('MeasureAccuracy', 'max_cpu_seconds'): [0.2, 0.5, -1.0, float('nan'), 1e308]}


class Requests:
    """Every random number is from `random`. Files are made and looked for in `folder` alone."""

    def __init__(self, random, folder):
        self.random = random
        self.folder = os.fsencode(folder)
        self.names = []  # of the bodies that there are, as bytes
        self.hostility = 0.0

    def request(self, kind):
        """The bytes of a request of this class."""
        service = kind._type.split('/')[-1].replace('Request', '')
        self.hostility = self.random.choice([0.0, 0.05, 0.3])
        data = b''.join(self.field(service, name, slot) for name, slot in zip(kind.__slots__, kind._slot_types))
        if self.random.random() < 0.01:  # cut, or with something behind
            return data[:self.random.randint(0, len(data))] if self.random.random() < 0.5 else data + b'\0' * 7
        return data

    def is_hostile(self):
        return self.random.random() < self.hostility

    def field(self, owner, name, slot):
        if slot.endswith(']'):
            return self.array(owner, name, slot)
        if (owner, name) in TAMED:
            return struct.pack(FORMATS[slot], self.random.choice(TAMED[owner, name]))
        if slot == 'string':
            return self.text(name)
        if slot in ('time', 'duration'):
            return struct.pack('<II', self.random.randint(0, 10), 0)
        if slot in FORMATS:
            return struct.pack(FORMATS[slot], self.number(slot))
        return self.message(slot)

    def message(self, slot):
        if slot == 'Header':
            slot = 'std_msgs/Header'
        if slot == 'geometry_msgs/Quaternion' and not self.is_hostile():
            return struct.pack('<4d', *self.random.choice([(0, 0, 0, 0), (0, 0, 0, 1), (0.5, 0.5, 0.5, 0.5)]))
        kind = roslib.message.get_message_class(slot)
        return b''.join(self.field(slot, *field) for field in zip(kind.__slots__, kind._slot_types))

    def array(self, owner, name, slot):
        element, size = slot[:-1].rsplit('[', 1)
        if size:
            count = int(size)
            return b''.join(self.field(owner, name, element) for _ in range(count))
        count = self.random.choice([0, 0, 1, 1, 1, 2, 3, 8])
        if self.is_hostile():
            count = self.random.choice([2, 20, 100, 300])
        return struct.pack('<I', count) + b''.join(self.field(owner, name, element) for _ in range(count))

    def number(self, slot):
        if slot == 'bool':
            return self.random.choice([0, 0, 0, 1]) if not self.is_hostile() else self.random.randint(0, 255)
        if slot.startswith('float'):
            if not self.is_hostile():
                return self.random.choice(SOUND_FLOATS) if self.random.random() < 0.7 else self.random.uniform(-5, 5)
            value = self.random.choice(HOSTILE_FLOATS)
            return value if slot == 'float64' or not 3.4e38 < abs(value) < float('inf') else float('inf')
        bits = 8 * struct.calcsize(FORMATS[slot])
        signed = FORMATS[slot][1].islower()
        low, high = (-2**(bits - 1), 2**(bits - 1) - 1) if signed else (0, 2**bits - 1)
        return self.random.choice([low, high, high - 1, high // 2]) if self.is_hostile() else self.random.randint(0, 3)

    def text(self, name):
        if name == 'file':
            value = self.file()
        elif name == 'mesh':
            value = self.random.choice([b'', b'', b'', self.file()])
        elif self.is_hostile():
            value = self.random.choice(HOSTILE_TEXTS)
        elif self.names and self.random.random() < 0.6:
            value = self.random.choice(self.names)
        else:
            value = self.random.choice(TEXTS)
        return struct.pack('<I', len(value)) + value

    def file(self):
        """A path that is refused, or one in the folder: these calls write."""
        inside = self.random.choice([b'a', b'b.yaml', b'c.stl', b'no/such', b'.yaml', b'a' * 300, b'a\0b', b'\xff', b'', b'dir',
                                     b'dir.yaml', b'd e.yaml', b'g.obj', b'link.yaml'])
        if self.is_hostile():
            return self.random.choice([b'', b'x.yaml', b'../x.yaml', b'~/x.yaml', b'package://x', b'\0'])
        return self.folder + b'/' + inside
