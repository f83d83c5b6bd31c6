# SPDX-License-Identifier: BSD-3-Clause
"""The two cases of the course report: when to look at them, and the numbers that prove them.

A case has the name of its scene, the times of its frames (physics time, s), and table(): rows of Markdown
made from what was measured at those times. `states` is a list with, for each time, a dict from the name of
a body to its pose and twist as a BodyState message has them.
"""
import collections
import math

Case = collections.namedtuple('Case', 'scene times table')

GRAVITY = 9.81  # m/s²


def ball_and_wall(t):
    """Position, velocity and spin of the ball of ball_hits_wall at time t, in closed form.

    It rolls with v0 = 4 m/s, so its spin is w0 = v0 / r. The smooth wall turns v0 into -e v0 and leaves the
    spin. From then on the floor's friction acts: a = mu g on the velocity and, for a solid ball of moment
    2/5 m r², -5/2 mu g / r on the spin, until v = w r: rolling, with v = (5 (-e v0) + 2 w0 r) / 7.
    """
    v0, e, mu, r = 4.0, 0.8, 0.6, 0.25
    start, wall = -2.0, 2.0
    hit = (wall - r - start) / v0
    if t < hit:
        return start + v0 * t, v0, v0 / r
    v_roll = (-5 * e * v0 + 2 * v0) / 7
    slide = (v_roll + e * v0) / (mu * GRAVITY)
    s = min(t - hit, slide)
    v = -e * v0 + mu * GRAVITY * s
    w = v0 / r - 2.5 * mu * GRAVITY / r * s
    x = wall - r - e * v0 * s + 0.5 * mu * GRAVITY * s ** 2 + v_roll * (t - hit - s)
    return x, v, w


def ball_table(times, states):
    yield '| time, s | position x, m | predicted | velocity, m/s | predicted | spin, rad/s | predicted |'
    yield '|--:|--:|--:|--:|--:|--:|--:|'
    for t, state in zip(times, states):
        ball = state['ball']
        measured = ball.pose.position.x, ball.twist.linear.x, ball.twist.angular.y
        pairs = zip(measured, ball_and_wall(t))
        yield '| %.2f | %s |' % (t, ' | '.join('%.3f | %.3f' % pair for pair in pairs))


SLOPE = math.radians(25)
FRICTIONS = {'sticky': 0.8, 'rough': 0.6, 'smooth': 0.4, 'slippery': 0.2}  # with the slope
COLORS = {'sticky': 'red', 'rough': 'orange', 'smooth': 'green', 'slippery': 'blue'}


def down_slope(vector):
    return vector.x * math.cos(SLOPE) - vector.z * math.sin(SLOPE)


def tilt(state):
    """Angle between the long axis of the tall box and the vertical, degrees."""
    q = state['tall'].pose.orientation
    return math.degrees(math.acos(min(1.0, abs(1 - 2 * (q.x ** 2 + q.y ** 2)))))


def slope_table(times, states):
    first, second = 2, 3  # frames between which all four boxes lie on the slope
    span = times[second] - times[first]
    yield ('| box | friction | acceleration from %g to %g s, m/s² | predicted | creep from %g to %g s, m |'
           % (times[first], times[second], times[second], times[-1]))
    yield '|---|--:|--:|--:|--:|'
    for box, friction in FRICTIONS.items():
        speeds = [down_slope(state[box].twist.linear) for state in (states[first], states[second])]
        places = [down_slope(state[box].pose.position) for state in (states[second], states[-1])]
        predicted = max(0.0, GRAVITY * (math.sin(SLOPE) - friction * math.cos(SLOPE)))
        creep = '%.1g' % abs(places[1] - places[0]) if predicted == 0.0 else 'slides'
        yield '| %s (%s) | %.1f | %.4f | %.4f | %s |' % (
            box, COLORS[box], friction, round((speeds[1] - speeds[0]) / span, 4) + 0.0, predicted, creep)  # no minus zero
    yield ''
    yield '| time, s | tilt of the tall box from the vertical |'
    yield '|--:|--:|'
    for t, state in zip(times, states):
        yield '| %.2f | %.1f° |' % (t, tilt(state))


CASES = [Case('ball_hits_wall', [0.2, 0.9, 1.0, 1.3, 2.5], ball_table),
         Case('boxes_on_slope', [0.0, 0.5, 1.0, 2.0, 5.0], slope_table)]
