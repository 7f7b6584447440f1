#!/usr/bin/env python3
"""Writes the traces beside it, in evemu's format: hands as a 10.1 inch panel of 4096 x 2560 units tells them, about
100 packets a second, with a finger's jitter and the pointer that the kernel adds. No person moved them; what
evemu-record takes from a real panel can be laid here as it is."""
import math, os, random

PER_MM = 4096 / 217.0
SLOT, MAJOR, X, Y, ID, PRESSURE, TOOL = 0x2F, 0x30, 0x35, 0x36, 0x39, 0x3A, 0x37
here = os.path.dirname(os.path.abspath(__file__))


class Trace:
    def __init__(self, name, slots=True):
        self.rng = random.Random(name)
        self.slots, self.name, self.t, self.lines = slots, name, 0.0, []
        self.now, self.slot, self.ids = {}, 0, 41
        self.lines += ["# EVEMU 1.3", "N: %s" % ("Written panel, slots" if slots else "Written panel, packets"),
                       "I: 0003 0000 0000 0000", "P: 02 00 00 00 00 00 00 00"]
        for code, most in ([(SLOT, 9)] if slots else []) + [(MAJOR, 4095), (X, 4095), (Y, 2559)]:
            self.lines.append("A: %02x 0 %d 0 0 %d" % (code, most, 0 if code == SLOT else round(PER_MM)))

    def e(self, kind, code, value):
        self.lines.append("E: %.6f %04x %04x %d" % (self.t, kind, code, value))

    def packet(self, fingers, dt=0.010):
        """fingers: {n: (x_mm, y_mm, major_mm)}; those left out are not on the glass"""
        self.t += dt + self.rng.uniform(-0.001, 0.001)
        jitter = lambda mm, most: min(most, max(0, round((mm + self.rng.gauss(0, 0.05)) * PER_MM)))
        if not self.slots:
            for n, (x, y, major) in sorted(fingers.items()):
                self.e(3, MAJOR, round(major * PER_MM)), self.e(3, X, jitter(x, 4095)), self.e(3, Y, jitter(y, 2559))
                self.e(0, 2, 0)
            if not fingers:
                self.e(0, 2, 0)
            return self.e(0, 0, 0)
        for n in sorted(set(self.now) | set(fingers)):
            had, has = self.now.get(n), fingers.get(n)
            if had is None and has is None:
                continue
            if self.slot != n:
                self.e(3, SLOT, n)
                self.slot = n
            if has is None:
                self.e(3, ID, -1)
            else:
                if had is None:
                    self.ids += 1
                    self.e(3, ID, self.ids)
                self.e(3, X, jitter(has[0], 4095)), self.e(3, Y, jitter(has[1], 2559))
                if had is None or had[2] != has[2]:
                    self.e(3, MAJOR, round(has[2] * PER_MM))
        if bool(self.now) != bool(fingers):
            self.e(1, 0x14A, 1 if fingers else 0)
        if fingers:  # the kernel's pointer
            x, y, _ = fingers[min(fingers)]
            self.e(3, 0, jitter(x, 4095)), self.e(3, 1, jitter(y, 2559))
        self.e(0, 0, 0)
        self.now = dict(fingers)

    def move(self, count, place):
        for i in range(count + 1):
            self.packet(place(i / count))

    def end(self):
        self.packet({})
        return self

    def write(self):
        with open(os.path.join(here, self.name + ".evemu"), "w") as out:
            out.write("\n".join(self.lines) + "\n")


def tap(t, x, y, packets=7):
    t.move(packets, lambda p: {0: (x + 0.4 * p, y, 7 + round(4 * p))})
    t.end()


t = Trace("tap"); tap(t, 100, 60); t.write()
t = Trace("double-tap"); tap(t, 100, 60); t.t += 0.09; tap(t, 103, 61); t.write()
t = Trace("long-press"); t.move(75, lambda p: {0: (100, 60, 9)}); t.end().write()
t = Trace("drag"); t.move(60, lambda p: {0: (60 + 50 * p, 60 + 20 * p, 8)})
t.move(20, lambda p: {0: (110, 80, 8)}); t.end().write()
t = Trace("flick"); t.move(9, lambda p: {0: (60 + 40 * p * p, 60, 8)}); t.end().write()
pinch = lambda p: {0: (100 - 20 - 40 * p, 60, 8), 1: (100 + 20 + 40 * p, 60, 8)}
t = Trace("pinch"); t.packet({0: (80, 60, 8)}); t.move(40, pinch); t.packet({1: (160, 60, 8)}); t.end().write()
t = Trace("pinch-protocol-a", slots=False); t.move(40, pinch); t.packet({1: (160, 60, 8)}); t.end().write()
turn = lambda p: {n: (100 + (2 * n - 1) * 30 * math.cos(p), 60 + (2 * n - 1) * 30 * math.sin(p), 8) for n in (0, 1)}
t = Trace("twist"); t.move(50, lambda p: turn(p * math.pi / 2)); t.end().write()
t = Trace("two-finger-drag"); t.move(40, lambda p: {0: (60 + 45 * p, 60, 8), 1: (90 + 45 * p, 60, 8)}); t.end().write()
# The edge of the hand comes to rest, grows, then a finger taps beside it.
t = Trace("palm-and-tap"); t.move(10, lambda p: {0: (180, 110, 26 + round(14 * p))})
t.move(7, lambda p: {0: (180, 110, 40), 1: (60, 40, 8)}); t.move(5, lambda p: {0: (180, 110, 40)}); t.end().write()
# A finger draws, the hand lies down behind it: the drag ends, nothing else comes of it.
t = Trace("finger-becomes-palm"); t.move(20, lambda p: {0: (60 + 20 * p, 60, 9)})
t.move(20, lambda p: {0: (80 + 10 * p, 60, 9 + round(25 * p))}); t.end().write()
