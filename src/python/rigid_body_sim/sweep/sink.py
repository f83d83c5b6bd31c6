# SPDX-License-Identifier: BSD-3-Clause
"""A file that HDF5 writes, whatever happens meanwhile."""
import os
import signal

INTERRUPTS = {signal.SIGINT, signal.SIGTERM}


class Sink:
    """A file for HDF5, whose library ends the process where a write fails or is interrupted. From the first that fails on, what is
    written is kept here, and signals are blocked; `check` raises the error or the interrupt, and should be called often."""

    def __init__(self, file):
        self.file, self.error, self.kept, self.place = file, None, [], 0

    def check(self):
        if self.error:
            raise self.error
        if signal.sigpending() & INTERRUPTS:
            raise KeyboardInterrupt

    def seek(self, offset, whence=os.SEEK_SET):
        ends = [begin + len(data) for begin, data in self.kept]
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self.place}.get(whence)
        self.place = (max(ends + [self.file.seek(0, os.SEEK_END)]) if base is None else base) + offset
        return self.place

    def tell(self):
        return self.place

    def write(self, data):
        data, done = bytes(data), 0
        while not self.error and done < len(data):
            try:
                self.file.seek(self.place + done)
                done += self.file.write(data[done:])
            except OSError as error:
                self.error = error
        if done < len(data):
            self.kept.append((self.place + done, data[done:]))
        self.place += len(data)
        return len(data)

    def read(self, size):
        begin = self.place
        self.file.seek(begin)
        data = bytearray(self.file.read(size).ljust(size, b'\0'))
        for place, kept in self.kept:
            first, last = max(place, begin), min(place + len(kept), begin + size)
            if first < last:
                data[first - begin:last - begin] = kept[first - place:last - place]
        self.place += size
        return bytes(data)

    def truncate(self, size=None):
        try:
            self.file.truncate(self.place if size is None else size)
        except OSError as error:
            self.error = self.error or error

    def flush(self):
        pass
