#!/usr/bin/python3
"""Boots the virtual board and runs its named tests. run.py NATIVE-BUILD ARM64-BUILD IMAGE-FOLDER [WORD...]

Two boots, the second after the power was cut in the first and with systemd, as a cart has it; one cart serves all tests between two changes of its tracker.
A cart that failed a test is killed and the next test has one of its own. With words: only tests whose names have one."""
import json, os, shutil, subprocess, sys, time

from PIL import Image, ImageChops

from board import Board, Failure, require, wait_for
from cart import FRAMES, Cart, losses

native, arm64, image = sys.argv[1:4]
words = sys.argv[4:]
work = os.path.join(image, 'run')
guest = lambda name: os.path.join(os.path.dirname(os.path.abspath(__file__)), 'guest', name)
tests = []


def test(name, cart=None, sweeps=1):
    """`cart`: it needs the cart of this name, and takes so many of its sweeps."""
    def wrap(function):
        tests.append((name, cart, sweeps, function))
        return function
    return wrap


class Bench:
    """The board that is on, and the cart that runs on it; both are made when a test needs them."""

    def __init__(self):
        self.board_ = None
        self.cart_ = None
        self.cart_name = None
        self.carts = 0
        self.held = True  # the first boot finds a foot on the pedal
        self.systemd = False  # whether the next boot is one with systemd
        self.touch = None  # the job that is the touchscreen
        self.exams = None  # folder on the board with an exam that nobody writes to any more
        self.left = {}    # sweeps that the tests still to come want of a cart

    def board(self):
        if self.board_ is None:
            self.board_ = Board(image, work, os.path.join(native, 'bin/virtual-usb'),
                                [os.path.join(arm64, 'bin/virtual-touch'), guest('as-kiosk'), guest('onto-the-stick')], held=self.held, systemd=self.systemd)
            self.held = False
        return self.board_

    def cart(self, name):
        if self.cart_ is None:
            self.carts += 1
            self.cart_name = f'{name}-{self.carts}'
            self.cart_ = Cart(self.board(), self.cart_name, self.left.get(name) or 1)
        return self.cart_

    def kill_cart(self):
        if self.cart_ is not None:
            self.cart_.kill()
        self.cart_ = None

    def tracker(self, name):
        """Pulls the plug of any other and waits until the kernel has seen it go."""
        usb = self.board().usb
        for other in ('liberty', 'viper', 'stranger'):
            if other != name:
                usb.say('unplug ' + other)
        usb.say('plug ' + name)
        product = {'liberty': 'ff20', 'viper': 'bf01', 'stranger': 'cf01'}[name]
        wait_for(lambda: self.board().run('cat /sys/bus/usb/devices/*/idProduct')[1].split().count(product) == 1 and
                 sum(p in ('ff20', 'bf01', 'cf01') for p in self.board().run('cat /sys/bus/usb/devices/*/idProduct')[1].split()) == 1,
                 f'the kernel to see {name} alone', ended=self.board().dead)


def touchscreen_on(board):
    """One that works as long as the board is on, by lines that are added to a file. Gives the job of its program."""
    open(os.path.join(board.share, 'fingers'), 'w').close()
    job = board.begin('tail -n +1 -f /share/fingers | /share/bin/virtual-touch')
    wait_for(lambda: 'Virtual touchscreen' in board.run('cat /proc/bus/input/devices')[1], 'the touchscreen', ended=board.dead)
    return job


def check(board):
    return board.run('sonoband --board virtual --check')


def tool(*arguments):
    done = subprocess.run([os.path.join(native, 'bin/sonoband-tool'), *arguments], capture_output=True, text=True)
    require(done.returncode == 0, f'sonoband-tool {arguments[0]} ended with {done.returncode}: {done.stderr[-300:]}')
    return done.stdout


def exam_of(folder):
    """From the shared folder."""
    listed = json.loads(tool('exams', folder, '--json'))['exams']
    require(len(listed) == 1, f'{len(listed)} exams in {folder}')
    return listed[0]


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


@test('a press during boot records nothing until the foot has come up', cart='liberty', sweeps=0)
def held(bench):
    cart = bench.cart('liberty')
    before = cart.wait(lambda s: s['video'] == 'running', 'pictures')['pictures']
    cart.wait(lambda s: s['pictures'] >= before + 10, 'ten pictures more')
    for line in cart.lines('state'):
        require(line['state'] in ('idle', 'live') and not line['armed'], f'it took the held pedal for a press: {line}')
    bench.board().release()
    cart.wait(lambda s: s['armed'], 'the pedal to count once it is up')
    return 'nothing recorded; armed when it came up'


@test('press, sweep, release: tracked, and no frame is lost', cart='liberty')
def sweep(bench):
    s = bench.cart('liberty').sweep()
    require(s['frames_with_pose'] >= FRAMES // 2, f'few frames have a pose: {s}')
    require(not losses(s), f'lost: {losses(s)}')
    return f"{s['frames']} frames, {s['frames_with_pose']} with a pose"


@test('the band is the one that the same sweep gives natively, and its exam is whole', cart='liberty', sweeps=0)
def band(bench):
    """The pose was written as text on the way: its last bit decides ties between pixels, and whether one more begins at the
    plane's far edges. The picture must not differ."""
    bench.cart('liberty').wait(lambda s: s['saved'] == s['frames'], 'all to be saved')
    name = bench.cart_name
    code, log = bench.board().run(f'sonoband-tool verify $(ls /data/{name}/exams/*.exam) && cp -r /data/{name} /share/out/')
    require(code == 0, f'verify ended with {code}: {log}')
    folder = os.path.join(bench.board().share, 'out', name)
    exam = exam_of(os.path.join(folder, 'exams'))
    to = os.path.join(work, 'exported')
    tool('export', exam['path'], '--to', to, '--sweep', '1')
    stem = os.path.join(to, exam['id'] + '-sweep1')
    here = os.path.join(work, 'band1.png')
    swept = bench.cart('liberty').lines('sweep')[0]['sweep']
    first = swept['pre_roll_frames']  # in the exam as well, but of no band
    frames = f"{first}-{first + swept['frames'] - 1}"
    left, top, right, bottom = Image.open(stem + '-mask.png').getbbox()  # which pixels count: a rectangle, in this scene
    clip = left, top, right - left, bottom - top
    tool('render', stem + '.igs.mha', '--calibration', stem + '.xml', '--frames', frames, '--clip', ','.join(map(str, clip)), '--thickness-mm', '3',
         '--compounding', 'max', '--out', here)
    a, b = (Image.open(f) for f in (os.path.join(folder, 'out/band1.png'), here))
    apart = [abs(m - n) for m, n in zip(a.size, b.size)]
    require(max(apart) <= 1 and a.mode == b.mode, f'{a.size} {a.mode} there, {b.size} {b.mode} here')
    common = 0, 0, min(a.size[0], b.size[0]), min(a.size[1], b.size[1])
    grey_a, grey_b = (p.crop(common).convert('L') for p in (a, b))
    brightest = grey_a.getextrema()[1]
    require(brightest > 60, f'the picture is dark: nothing is brighter than {brightest}')
    histogram = ImageChops.difference(grey_a, grey_b).histogram()
    pixels = common[2] * common[3]
    off = sum(histogram[5:])
    require(off <= pixels // 1000, f'{off} of {pixels} pixels differ by more than 4 levels')
    return f'{a.size[0]} x {a.size[1]}, {pixels - histogram[0]} pixels differ at all'


@test('a bouncing pedal is one press and one release', cart='liberty')
def bounce(bench):
    board, cart = bench.board(), bench.cart('liberty')
    chatter = lambda: [board.monitor.line(0, level) for level in (1, 0) * 10]
    cart.ready()
    chatter()
    board.press()
    cart.wait(lambda s: s['state'] == 'recording', 'a press to record')
    cart.frames(FRAMES)
    chatter()
    board.release()
    cart.wait(lambda s: s['state'] == 'review', 'the release to end the sweep')
    s = cart.swept()
    require(s['frames'] >= FRAMES, f'the sweep was cut short: {s}')
    return f"{s['frames']} frames"


@test('edges of the pedal are lost: its level is read again', cart='liberty')
def lost_edge(bench):
    """More edges than the kernel keeps for a cart that does not read: it drops the newest, and with them the release."""
    board, cart = bench.board(), bench.cart('liberty')
    cart.ready()
    board.press()
    cart.wait(lambda s: s['state'] == 'recording', 'a press to record')
    cart.frames(FRAMES)
    lost = cart.now()['lost_edges']
    require(board.run('kill -STOP $(pidof sonoband)')[0] == 0, 'the cart cannot be stopped')
    for i in range(41):
        board.monitor.line(0, i % 2)
        time.sleep(0.01)
    board.release()
    require(board.run('kill -CONT $(pidof sonoband)')[0] == 0, 'the cart cannot go on')
    cart.wait(lambda s: s['state'] == 'review' and not s['down'], 'the level of the pedal to end the sweep')
    cart.swept()
    return f"{cart.now()['lost_edges'] - lost} counted as lost"


@test('the tracker is unplugged in mid-sweep, and back', cart='liberty')
def unplug(bench):
    board, cart = bench.board(), bench.cart('liberty')

    def away():
        board.usb.say('unplug liberty')
        cart.wait(lambda s: s['tracker'] != 'running', 'the cart to miss the tracker')
        cart.frames(3)
        board.usb.say('plug liberty')
        cart.wait(lambda s: s['tracker'] == 'running', 'the tracker to be back')
        cart.frames(8)
    s = cart.sweep(away)
    without = s['frames'] - s['frames_with_pose']
    require(s['frames_with_pose'] >= FRAMES, f'few frames have a pose: {s}')
    require(without >= 3, 'no frame is without a pose, though the tracker was away')
    require(not losses(s), f'lost: {losses(s)}')
    return f"{s['frames']} frames, {without} of them without a pose"


@test('the video stalls, which ends the sweep, and resumes', cart='liberty')
def stall(bench):
    board, cart = bench.board(), bench.cart('liberty')
    cart.ready()
    board.press()
    cart.wait(lambda s: s['state'] == 'recording', 'a press to record')
    cart.frames(FRAMES)
    board.usb.say('stall')
    told = cart.wait(lambda s: s['state'] == 'review', 'the silence to end the sweep')
    require('pictures stopped' in told['note'], f'the operator is told {told["note"]!r}')
    board.release()
    before = told['pictures']
    board.usb.say('resume')
    cart.wait(lambda s: s['video'] == 'running' and s['pictures'] >= before + 5, 'pictures to come again')
    s = cart.swept()
    require(s['frames'] >= FRAMES, f'frames from before the silence are missing: {s}')
    return f"{s['frames']} frames kept"


@test('a touchscreen is seen, and --check finds every device')
def touchscreen(bench):
    board = bench.board()
    board.release()
    bench.tracker('liberty')
    bench.touch = touchscreen_on(board)
    code, log = check(board)
    for device in ('tracker', 'video', 'pedal', 'touch', 'display', 'clock'):
        require(f'found    {device}' in log, f'{device} is not found: {log}')
    require(code == 0, f'--check ended with {code}: {log}')
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
    at = wait_for(lambda: said('widget'), 'the cart to say where to touch', ended=ended)
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


@test('a wrong USB device is named')
def wrong_device(bench):
    bench.tracker('stranger')
    code, log = check(bench.board())
    require(code == 1, f'--check ended with {code}: {log}')
    require('unknown Polhemus device: 0f44:cf01' in log, log)
    return 'unknown Polhemus device: 0f44:cf01, exit code 1'


@test('a VIPER in place of the LIBERTY', cart='viper')
def viper(bench):
    bench.tracker('viper')
    code, log = check(bench.board())
    require('VIPER on USB' in log and code == 0, log)
    s = bench.cart('viper').sweep()
    require(s['frames_with_pose'] >= FRAMES // 2, f'few frames have a pose: {s}')
    require(not losses(s), f'lost: {losses(s)}')
    return f"{s['frames']} frames, {s['frames_with_pose']} with a pose"


@test('the power is cut while recording: all that was acknowledged is there after the next boot', cart='viper')
def power_cut(bench):
    bench.tracker('viper')
    cart = bench.cart('viper')
    name = bench.cart_name
    bench.touch = None
    cart.ready()
    bench.board().press()
    cart.wait(lambda s: s['state'] == 'recording', 'a press to record')
    cart.frames(FRAMES)
    bench.board().cut()
    said, ended = cart.now(), len(cart.lines('sweep'))
    bench.cart_ = bench.board_ = None
    bench.systemd = True
    board = bench.board()
    # The cart itself recovers it, and can be used.
    code, log = board.run(f'cd /tmp && echo "await live 20" >s && sonoband --board sim --headless --script s --out o --exams /data/{name}/exams && '
                          f'sonoband-tool verify $(ls /data/{name}/exams/*.exam) && cp -r /data/{name} /share/out/')
    require(code == 0, f'after the cut the cart ended with {code}: {log[-400:]}')
    told = [line for line in log.split('\n') if line.startswith('sonoband: ')]
    require(told, f'the next start says nothing of a recovery: {log[-400:]}')
    exam = exam_of(os.path.join(board.share, 'out', name, 'exams'))
    tool('verify', exam['path'])
    require(exam['frames'] >= said['saved'], f"{exam['frames']} frames are there, {said['saved']} were acknowledged")
    require(exam['closed'] and exam['sweeps'] == ended + 1, f'not whole: {exam}')
    bench.exams = f'/data/{name}/exams'
    return f"{said['saved']} frames acknowledged, {exam['frames']} there; {told[-1][10:]}"


@test('after the power cut the cart takes a sweep', cart='again')
def again(bench):
    s = bench.cart('again').sweep()
    require(s['frames_with_pose'] >= FRAMES // 2 and not losses(s), f'{s}')
    return f"{s['frames']} frames, {s['frames_with_pose']} with a pose"


@test('a stick is mounted as it is plugged in, the kiosk service exports an exam onto it and lets it go')
def stick(bench):
    """FAT on a USB disk, plugged in while the service runs, and again before it starts: its name space must see both."""
    if bench.exams is None:
        bench.tracker('viper')
        again(bench)
        bench.exams = bench.cart('again').folder + '/exams'
        cart, bench.cart_ = bench.cart_, None
        cart.end()
    if not bench.board().systemd:
        board, bench.board_, bench.touch, bench.systemd = bench.board_, None, None, True
        board.off()
    board = bench.board()
    code, log = board.run(f'systemd-tmpfiles --create sonoband.conf; mkdir -p /var/lib/sonoband/exams && cp {bench.exams}/*.exam /var/lib/sonoband/exams/ && '
                          f'chown -R sonoband:sonoband /var/lib/sonoband && cp {bench.exams}/*.exam /share/out/')
    require(code == 0, f'the exam cannot be given to the cart: {log}')
    exam = next(f for f in os.listdir(os.path.join(board.share, 'out')) if f.endswith('.exam'))
    here = os.path.join(work, 'stick-here')
    tool('export', os.path.join(board.share, 'out', exam), '--to', here, '--format', 'mha', '--sweep', '1')
    place = '/run/media/sonoband/sda'
    mounted = lambda: board.run(f'grep -c " {place} " /proc/self/mountinfo')[1].strip() == '1'
    for n, plugged in enumerate(('while the service runs', 'before it starts')):
        if plugged == 'before it starts':
            board.plug_stick()
            wait_for(mounted, 'the stick to be mounted', ended=board.dead)
        job = board.begin(f'/share/bin/as-kiosk kiosk{n} /share/bin/onto-the-stick {place} /var/lib/sonoband/exams/{exam}')
        if plugged == 'while the service runs':
            wait_for(lambda: board.run(f'systemctl is-active kiosk{n}.service')[1].strip() == 'activating', 'the service to run', ended=board.dead)
            board.plug_stick()
        code, log = board.end(job)
        require(code == 0, f'{plugged}, the export ended with {code}: {log[-600:]}')
        places = json.JSONDecoder().raw_decode(log[log.index('{'):])[0]['places']
        require([(p['path'], p['label']) for p in places] == [(place, 'ULTRASOUND')], f'{plugged}, the places are {places}')
        require(not mounted(), f'{plugged}, the stick is still mounted')
        board.pull_stick()
        size = same_files(os.path.join(work, 'stick.fat'), here)
    return f'{len(os.listdir(here))} files, {size / 1e6:.1f} MB, the same bytes as written here, plugged in before and after the service started'


def same_files(stick, here):
    """Bytes of what is on a stick in `taken`, the same as in the folder `here`; takes it from the stick."""
    taken = os.path.join(work, 'taken')
    shutil.rmtree(taken, ignore_errors=True)
    for words in (('mcopy', '-s', '-i', stick, '::/taken', work), ('mdeltree', '-i', stick, '::/taken')):
        done = subprocess.run(words, capture_output=True, text=True)
        require(done.returncode == 0, f'the stick cannot be read here: {done.stderr}')
    names = sorted(os.listdir(here))
    require(names and sorted(os.listdir(taken)) == names, f'{sorted(os.listdir(taken))} on the stick, {names} here')
    size = 0
    for name in names:
        a, b = (open(os.path.join(folder, name), 'rb').read() for folder in (taken, here))
        require(a == b, f'{name} is another file on the stick than here')
        size += len(a)
    return size


@test('the board switches itself off')
def off(bench):
    board = bench.board()
    bench.kill_cart()
    bench.board_ = None
    board.off()


def judge(bench, name, function):
    began = time.monotonic()
    try:
        said, passed = function(bench) or '', True
    except Failure as e:
        said, passed = str(e), False
    except Exception as e:  # a defect of this program is a failure of the test that showed it
        said, passed = f'{type(e).__name__}: {e}', False
    print(f"{'passed' if passed else 'FAILED'}  {name}  ({time.monotonic() - began:.0f} s)  {said}", flush=True)
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


def main():
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    disk = os.path.join(work, 'data.ext4')
    with open(disk, 'wb') as f:
        f.truncate(2 << 30)  # more than exams.reserve-mb, or no sweep starts
    subprocess.run(['mke2fs', '-q', '-t', 'ext4', '-F', disk], check=True)
    stick_disk = os.path.join(work, 'stick.fat')
    with open(stick_disk, 'wb') as f:
        f.truncate(64 << 20)
    subprocess.run(['mkfs.vfat', '-n', 'ULTRASOUND', stick_disk], check=True, stdout=subprocess.DEVNULL)
    bench = Bench()
    chosen = [t for t in tests if not words or any(word in t[0] for word in words)]
    results = []
    for n, (name, cart, _, function) in enumerate(chosen):
        for _, of, _, _ in chosen:
            bench.left[of] = sum(sweeps for _, c, sweeps, _ in chosen[n:] if c == of)
        passed = judge(bench, name, function)
        later = any(t[1] == cart for t in chosen[n + 1:])
        results.append(clean_up(bench, passed, cart is not None and not later) and passed)
    if bench.board_ is not None:  # not all tests were chosen, or the last could not
        bench.board_.cut()
    print(f'{sum(results)} passed, {len(results) - sum(results)} failed')
    return 0 if results and all(results) else 1


if __name__ == '__main__':
    sys.exit(main())
