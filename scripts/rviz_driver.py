# SPDX-License-Identifier: BSD-3-Clause
"""A real RViz on a screen of its own, with a real mouse: for the GUI test and the pictures.

The screen is an Xvfb without a window manager; the mouse and the keys are those of xdotool. Pixels are
counted from the top left corner of the screen.
"""
import collections
import math
import os
import re
import subprocess
import tempfile
import time

import yaml

PATIENCE = 60.0  # s, for a window to open or a picture to come to rest, on a busy machine

View = collections.namedtuple('View', 'eye target')      # m, in world
Window = collections.namedtuple('Window', 'id x y width height')
Picture = collections.namedtuple('Picture', 'width height rgb')  # rgb: three bytes a pixel, by rows

FIELD_OF_VIEW = math.radians(45)  # vertical


def wait_until(condition, what, patience=PATIENCE, period=0.1):
    """The first true value of condition(). Raises TimeoutError that says `what` did not happen."""
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(period)
    raise TimeoutError('after %g s still not: %s' % (patience, what))


class Screen:
    """An X server of its own, as a context manager."""

    def __init__(self, width=1280, height=800):
        self.size = '%dx%dx24' % (width, height)

    def __enter__(self):
        reader, writer = os.pipe()
        self.server = subprocess.Popen(
            ['Xvfb', '-displayfd', str(writer), '-screen', '0', self.size, '-nolisten', 'tcp', '-noreset'],
            pass_fds=[writer], stderr=subprocess.DEVNULL)
        os.close(writer)
        with os.fdopen(reader) as number:
            line = number.readline().strip()
        if not line:
            raise RuntimeError('Xvfb did not start')
        self.env = dict(os.environ, DISPLAY=':' + line)
        return self

    def __exit__(self, *error):
        self.server.terminate()
        self.server.wait()

    def run(self, *command):
        return subprocess.run(command, env=self.env, check=True, stdout=subprocess.PIPE).stdout

    def output(self, *command):
        """What a command prints, or None if it fails."""
        done = subprocess.run(command, env=self.env, check=False, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        return None if done.returncode else done.stdout

    def xdotool(self, *arguments):
        return self.run('xdotool', *(str(argument) for argument in arguments)).decode()

    def picture(self, window=None):
        """What is on the screen now, or what is seen of one window."""
        header = re.compile(rb'P6\s+(\d+)\s+(\d+)\s+255\s')
        ppm = self.run('import', '-window', 'root', *crop(window), '-depth', '8', 'ppm:-')
        match = header.match(ppm)
        return Picture(int(match[1]), int(match[2]), ppm[match.end():])

    def save(self, path, window=None):
        """Writes a PNG of the screen, or of what is seen of one window."""
        self.run('import', '-window', 'root', *crop(window), path)


class Rviz:
    """RViz with a saved layout, as a context manager. `change` may edit the layout, a tree of dicts."""

    def __init__(self, screen, layout, change=lambda layout: None):
        self.screen = screen
        with open(layout) as file:
            self.layout = yaml.safe_load(file)
        change(self.layout)

    def __enter__(self):
        self.log = tempfile.TemporaryFile(mode='w+')
        with tempfile.NamedTemporaryFile('w', suffix='.rviz', delete=False) as file:
            yaml.safe_dump(self.layout, file)
        self.file = file.name
        self._start()
        try:
            self.window = wait_until(self._find_window, 'the window of RViz is open')
            wait_for_alike(lambda: self.scene, 10, 'RViz has laid out its window')
            self.focus()
        except Exception:
            self.__exit__()
            raise
        self.screen.xdotool('mousemove', 1, 1)  # away from the scene
        return self

    def _start(self):
        # A plugin with a sanitizer needs its library before the program that loads it.
        env = dict(self.screen.env, LD_PRELOAD=os.environ.get('RBS_RVIZ_PRELOAD', ''))
        self.process = subprocess.Popen(['rviz', '-d', self.file], env=env, stdout=self.log, stderr=subprocess.STDOUT)

    def __exit__(self, *error):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.remove(self.file)

    def focus(self):
        """Hands the keys to RViz. There is no window manager to do it; a window takes none before it can be seen."""
        wait_until(lambda: self.screen.output('xdotool', 'windowfocus', str(self.window)) is not None, 'RViz takes the keys')

    def output(self):
        """All that RViz has printed so far."""
        self.log.seek(0)
        return self.log.read()

    def _tree(self):
        if self.process.poll() is not None:
            raise RuntimeError('RViz ended:\n' + self.output())
        # It fails where a window, such as a menu's, closes while the tree is read.
        return wait_until(lambda: self.screen.output('xwininfo', '-root', '-tree'), 'the tree of windows is read').decode()

    def _find_window(self):
        # One start in some hundreds, Ogre does not find the window that Qt made for it, and RViz gives up
        # (https://github.com/ros2/rviz/issues/1245). A person would start it again.
        if self.process.poll() is not None and 'Invalid parentWindowHandle' in self.output():
            self.log.seek(0)
            self.log.truncate()
            self._start()
        match = re.search(r'(0x[0-9a-f]+) "[^"]*- RViz"', self._tree())
        return match and int(match[1], 16)

    @property
    def scene(self):
        """The window that Ogre draws in, where it is now: RViz moves it when its panels come."""
        return wait_until(self._find_scene, 'RViz draws its scene')

    def _find_scene(self):
        """The largest window without a name that has no window inside, or None."""
        row = re.compile(r'^( +)(0x[0-9a-f]+) (".*"|\(has no name\)):.*  (\d+)x(\d+)\+-?\d+\+-?\d+  \+(-?\d+)\+(-?\d+)$',
                         re.MULTILINE)
        rows = [match.groups() for match in row.finditer(self._tree())]
        leaves = [row for row, after in zip(rows, rows[1:] + [('', )]) if len(after[0]) <= len(row[0])]
        found = [Window(int(id, 16), int(x), int(y), int(width), int(height))
                 for _, id, name, width, height, x, y in leaves if name == '(has no name)']
        found = [window for window in found if window.width > 200 and window.height > 200]
        return max(found, key=lambda window: window.width * window.height, default=None)

    def pixel_of(self, point):
        """Where the orbit view of the layout shows a point of the world, m."""
        view = self.layout['Visualization Manager']['Views']['Current']
        focus = [view['Focal Point'][axis] for axis in 'XYZ']
        pitch, yaw = view['Pitch'], view['Yaw']
        to_eye = (math.cos(pitch) * math.cos(yaw), math.cos(pitch) * math.sin(yaw), math.sin(pitch))
        right = (-math.sin(yaw), math.cos(yaw), 0.0)
        up = (-math.sin(pitch) * math.cos(yaw), -math.sin(pitch) * math.sin(yaw), math.cos(pitch))
        from_focus = [p - f for p, f in zip(point, focus)]
        depth = view['Distance'] - dot(from_focus, to_eye)
        scene = self.scene
        scale = scene.height / (2 * math.tan(view['Field of View'] / 2)) / depth
        return (round(scene.x + scene.width / 2 + scale * dot(from_focus, right)),
                round(scene.y + scene.height / 2 - scale * dot(from_focus, up)))

    def drag(self, start, end, steps=12):
        """Drags what lies at pixel `start` to `end`, once it can be dragged. Nothing else may move."""
        wait_until(lambda: self._takes_drags(start), 'something to drag at pixel %d, %d' % start)
        self.sweep(start, end, steps)

    def sweep(self, start, end, steps=12):
        """Moves the mouse from one pixel to another with its left button down."""
        mouse = self.screen.xdotool
        mouse('mousemove', *start, 'sleep', 0.2)
        mouse('mousedown', 1, 'sleep', 0.2)
        for step in range(1, steps + 1):
            x, y = (round(a + (b - a) * step / steps) for a, b in zip(start, end))
            mouse('mousemove', x, y, 'sleep', 0.05)
        mouse('sleep', 0.3, 'mouseup', 1)

    def _takes_drags(self, pixel):
        """Moves the mouse to a pixel. Whether the hints in the status bar become others than those of the sky."""
        scene = self.scene
        hints = Window(None, 0, scene.y + scene.height, scene.x + scene.width // 2, 28)

        def hints_with_mouse_at(x, y):
            self.screen.xdotool('mousemove', x - 2, y - 2, 'sleep', 0.2, 'mousemove', x, y, 'sleep', 0.5)
            return self.screen.picture(hints)

        of_sky = hints_with_mouse_at(scene.x + 20, scene.y + 20)
        if hints_with_mouse_at(*pixel) != of_sky:
            return True
        time.sleep(5.0)  # for a picture of thousands of bodies
        return self.screen.picture(hints) != of_sky

    def click(self, pixel, held=None):
        """Clicks with the left button, while the key `held` is down where one is given."""
        keys = (['keydown', held], ['sleep', 0.1, 'keyup', held]) if held else ([], [])
        self.screen.xdotool('mousemove', *pixel, 'sleep', 0.2, *keys[0], 'click', 1, *keys[1])

    def key(self, name):
        self.focus()
        self.screen.xdotool('sleep', 0.2, 'key', name)

    def find_color(self, color, least=20):
        """The middle pixel of what is drawn in exactly this colour outside the scene, or None."""
        scene, picture = self.scene, self.screen.picture()
        wanted, found, at = bytes(color), [], -1
        while True:
            at = picture.rgb.find(wanted, at + 1)
            if at < 0:
                break
            y, x = divmod(at // 3, picture.width)
            if at % 3 == 0 and not contains(scene, x, y):
                found.append((x, y))
        if len(found) < least:
            return None
        return tuple(sorted(pixel[axis] for pixel in found)[len(found) // 2] for axis in (0, 1))

    def wait_for_rest(self):
        """Waits until the scene looks the same several times in a row."""
        wait_for_alike(lambda: self.screen.picture(self.scene), 4, 'the picture is at rest')


def wait_for_alike(seen, times, what):
    """Waits until seen() has been the same several times in a row, 0.15 s apart."""
    last, count = None, 0

    def is_alike():
        nonlocal last, count
        now = seen()
        count = count + 1 if now == last else 1
        last = now
        return count >= times

    wait_until(is_alike, what, period=0.15)


def contains(window, x, y):
    return window.x <= x < window.x + window.width and window.y <= y < window.y + window.height


def crop(window):
    """The options of ImageMagick that leave one window of the screen; all of it for None."""
    if window is None:
        return []
    return ['-crop', '%dx%d+%d+%d' % (window.width, window.height, window.x, window.y), '+repage']


def look_from(layout, view):
    """Puts the orbit view of a layout where `view` says."""
    to_eye = [e - t for e, t in zip(view.eye, view.target)]
    distance = math.sqrt(dot(to_eye, to_eye))
    layout['Visualization Manager']['Views']['Current'].update({
        'Distance': distance,
        'Focal Point': dict(zip('XYZ', view.target)),
        'Pitch': math.asin(to_eye[2] / distance),
        'Yaw': math.atan2(to_eye[1], to_eye[0]) % (2 * math.pi),
        'Field of View': FIELD_OF_VIEW})


def leave_only_the_scene(layout, width, height):
    """Takes the panels out of a layout and sets the size of RViz's window, in pixels."""
    layout['Panels'] = []
    layout['Window Geometry'] = {'Width': width, 'Height': height, 'X': 0, 'Y': 0}


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))
