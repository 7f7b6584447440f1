"""What the board has: its devices are found, and what is wrong with one is said."""
import json, os

from PIL import Image

from bench import test
from board import PATIENCE, require, wait_for
from cart import FRAMES, Cart, losses


def touchscreen_on(board):
    """One that works as long as the board is on, by lines that are added to a file. Gives the job of its program."""
    open(os.path.join(board.share, 'fingers'), 'w').close()
    job = board.begin('tail -n +1 -f /share/fingers | /share/bin/virtual-touch')
    wait_for(lambda: 'Virtual touchscreen' in board.run('cat /proc/bus/input/devices')[1], 'the touchscreen', ended=board.dead)
    return job


def check(board):
    return board.run('sonoband --board virtual --check')


@test('boots; --check finds every device and that the pedal is held')
def boots(bench):
    code, log = check(bench.board())
    for device in ('tracker', 'video', 'display'):
        require(f'found    {device}' in log, f'{device} is not found: {log}')
    require('warning  pedal' in log and 'down' in log and code == 0, f'ended with {code}: {log}')
    return next(line for line in log.split('\n') if 'tracker' in line)[18:]


@test('the tracker streams', cart='liberty', sweeps=0)
def streams(bench):
    cart = bench.cart('liberty')
    first = cart.wait(lambda s: s['tracker'] == 'running' and s['readings'] > 0, 'the tracker to run')['readings']
    more = cart.wait(lambda s: s['readings'] >= first + 100 and s['pictures'] >= 5, '100 readings and 5 pictures more')
    return f"{more['readings']} readings, {more['pictures']} pictures"


@test("a touchscreen is seen, and --check is all green for the cart's user")
def touchscreen(bench):
    board = bench.board()
    board.release()
    bench.tracker('liberty')
    bench.touch = touchscreen_on(board)
    # As the cart's user, by what udev's rules alone let him open, with the limits that the kiosk's unit grants.
    code, log = board.run('udevadm settle; ulimit -l unlimited; ulimit -r 50; '
                          'exec /usr/bin/setpriv --reuid=sonoband --regid=sonoband --clear-groups sonoband --board virtual --check')
    for device in ('tracker', 'video', 'pedal', 'touch', 'display', 'clock', 'limits'):
        require(f'found    {device}' in log, f'{device} is not found: {log}')
    require(code == 0 and 'warning' not in log and 'MISSING' not in log, f'--check ended with {code}: {log}')
    return next(line for line in log.split('\n') if 'touch' in line)[18:]


@test('a finger on the touchscreen turns the page of the running cart')
def finger(bench):
    """The cart's own screen, in memory, with the kernel's touchscreen: by the finger alone it gets from Live to Exams."""
    board = bench.board()
    board.release()
    bench.tracker('liberty')
    if bench.touch is None:
        bench.touch = touchscreen_on(board)
    with open(os.path.join(board.share, 'finger.script'), 'w') as f:
        f.write('await live 300\nwhere rail/exams\nawait-page exams 600\nshot exams.png\n')
    job = board.begin('exec sonoband --board virtual --headless --size 640x480 --script /share/finger.script --out /share/out/finger --exams /tmp/finger')

    def said(key):
        lines = [json.loads(line) for line in board.log(job).split('\n')[:-1] if line.startswith('{')]
        return next((line for line in lines if key in line), None)
    ended = lambda: board.dead() or (f'the cart ended: {board.log(job)[-300:]}' if board.code(job) else None)
    # Before its first picture the cart draws each kind of thing once, which takes the emulated machine long.
    at = wait_for(lambda: said('widget'), 'the cart to say where to touch', 3 * PATIENCE, ended)
    x, y = round(at['x'] * 1279), round(at['y'] * 799)
    for line in (f'down {x} {y}', 'up'):
        with open(os.path.join(board.share, 'fingers'), 'a') as f:
            f.write(line + '\n')
        wait_for(lambda: line in board.log(bench.touch).split('\n'), f'the touchscreen to do {line!r}', ended=ended)
    wait_for(lambda: said('page'), 'the page to turn', ended=ended)
    code, log = board.end(job)
    require(code == 0, f'the cart ended with {code}: {log[-300:]}')
    require(Image.open(os.path.join(board.share, 'out/finger/exams.png')).size == (640, 480), 'the screen has another size')
    return f'touched at {x}, {y} of 1280 x 800; the page is {said("page")["page"]}'


@test('libcamera finds the same grabber, and a sweep by it is whole')
def by_libcamera(bench):
    board = bench.board()
    bench.tracker('liberty')
    with open(os.path.join(board.share, 'libcamera.toml'), 'w') as f:
        f.write('[capture]\ndriver = "libcamera"\n')
    options = '--config /share/libcamera.toml'
    code, log = board.run('sonoband --board virtual --check ' + options)
    found = next((line for line in log.split('\n') if line.startswith('found    video')), '')
    require('of libcamera' in found, f'ended with {code}: {log}')
    cart = Cart(board, 'libcamera', 1, options)
    try:
        cart.take()
        s = cart.account()
        require(s['frames_with_pose'] >= FRAMES // 2 and not losses(s), f'{s}')
    finally:
        cart.kill()
    return f"{found[18:]}; {s['frames']} frames, {s['frames_with_pose']} with a pose"


@test('a wrong USB device is named')
def wrong_device(bench):
    bench.tracker('stranger')
    code, log = check(bench.board())
    require(code == 1, f'--check ended with {code}: {log}')
    require('unknown Polhemus device: 0f44:cf01' in log, log)
    return 'unknown Polhemus device: 0f44:cf01, exit code 1'
