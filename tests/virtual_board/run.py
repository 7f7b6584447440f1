#!/usr/bin/python3
"""Boots the virtual board and runs its named tests. run.py NATIVE-BUILD ARM64-BUILD IMAGE-FOLDER [WORD...]

Two boots, the second after the power was cut in the first and with systemd, as a cart has it; one cart serves all tests between two changes of its tracker.
A cart that failed a test is killed and the next test has one of its own. With words: only tests whose names have one."""
import os, shutil, subprocess, sys, time

import devices, storage, sweeps
from bench import Bench
from board import Failure

# In the order of the board's day: later ones use what earlier ones left running.
TESTS = (devices.boots, devices.streams, sweeps.held, sweeps.sweep, sweeps.band, sweeps.bounce, sweeps.lost_edge, sweeps.unplug,
         sweeps.stall, devices.by_libcamera, devices.touchscreen, devices.finger, devices.wrong_device, sweeps.viper, storage.power_cut, storage.again,
         storage.stick, storage.off)


def judge(bench, test):
    began = time.monotonic()
    try:
        said, passed = test.run(bench) or '', True
    except Failure as e:
        said, passed = str(e), False
    except Exception as e:  # a defect of this program is a failure of the test that showed it
        said, passed = f'{type(e).__name__}: {e}', False
    print(f"{'passed' if passed else 'FAILED'}  {test.name}  ({time.monotonic() - began:.0f} s)  {said}", flush=True)
    return passed


def clean_up(bench, passed, last):
    """Between two tests: nothing of a failed one is left, and a cart whose sweeps are taken ends by itself."""
    try:
        if bench.board_ is not None and bench.board_.dead():
            bench.board_.cut()
            bench.board_ = bench.cart_ = None
        if not passed and bench.cart_ is not None:
            bench.kill_cart()
        if last and bench.cart_ is not None:
            if bench.cart_.sweeps < bench.cart_.planned:
                bench.kill_cart()
            else:
                cart, bench.cart_ = bench.cart_, None
                cart.end()
        return True
    except Exception as e:
        print(f'FAILED  to go on after it: {e}', flush=True)
        if bench.board_ is not None:
            bench.board_.cut()
        bench.board_ = bench.cart_ = None
        return False


def blank_disks(work):
    """The board's data disk, and a stick."""
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    disk, stick = (os.path.join(work, name) for name in ('data.ext4', 'stick.fat'))
    for name, size in ((disk, 2 << 30), (stick, 64 << 20)):  # data: more than exams.reserve-mb, or no sweep starts
        with open(name, 'wb') as f:
            f.truncate(size)
    subprocess.run(['mke2fs', '-q', '-t', 'ext4', '-F', disk], check=True)
    subprocess.run(['mkfs.vfat', '-n', 'ULTRASOUND', stick], check=True, stdout=subprocess.DEVNULL)


def main():
    bench = Bench(*sys.argv[1:4])
    words = sys.argv[4:]
    blank_disks(bench.work)
    chosen = [t for t in TESTS if not words or any(word in t.name for word in words)]
    results = []
    for n, test in enumerate(chosen):
        for of in chosen:
            bench.left[of.cart] = sum(t.sweeps for t in chosen[n:] if t.cart == of.cart)
        passed = judge(bench, test)
        later = any(t.cart == test.cart for t in chosen[n + 1:])
        results.append(clean_up(bench, passed, test.cart is not None and not later) and passed)
    if bench.board_ is not None:  # not all tests were chosen, or the last could not
        bench.board_.cut()
    print(f'{sum(results)} passed, {len(results) - sum(results)} failed')
    return 0 if results and all(results) else 1


if __name__ == '__main__':
    sys.exit(main())
