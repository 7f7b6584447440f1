"""Sweeps by the pedal, and what goes wrong while one is recorded."""
import os, time

from PIL import Image, ImageChops

from bench import test
from board import require
from cart import FRAMES, losses
from devices import check


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
    exam = bench.exam_of(os.path.join(folder, 'exams'))
    to = os.path.join(bench.work, 'exported')
    bench.tool('export', exam['path'], '--to', to, '--sweep', '1')
    stem = os.path.join(to, exam['id'] + '-sweep1')
    here = os.path.join(bench.work, 'band1.png')
    swept = bench.cart('liberty').lines('sweep')[0]['sweep']
    first = swept['pre_roll_frames']  # in the exam as well, but of no band
    frames = f"{first}-{first + swept['frames'] - 1}"
    left, top, right, bottom = Image.open(stem + '-mask.png').getbbox()  # which pixels count: a rectangle, in this scene
    clip = left, top, right - left, bottom - top
    bench.tool('render', stem + '.igs.mha', '--calibration', stem + '.xml', '--frames', frames, '--clip', ','.join(map(str, clip)), '--thickness-mm', '3',
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


@test('the video stalls, which ends the sweep, resumes, and the next sweep is whole', cart='liberty', sweeps=2)
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
    after = cart.sweep()
    require(after['frames_with_pose'] >= FRAMES // 2 and not losses(after), f'the sweep after it: {after}')
    return f"{s['frames']} frames kept, {after['frames']} in the sweep after it"


@test('a VIPER in place of the LIBERTY', cart='viper')
def viper(bench):
    bench.tracker('viper')
    code, log = check(bench.board())
    require('VIPER on USB' in log and code == 0, log)
    s = bench.cart('viper').sweep()
    require(s['frames_with_pose'] >= FRAMES // 2, f'few frames have a pose: {s}')
    require(not losses(s), f'lost: {losses(s)}')
    return f"{s['frames']} frames, {s['frames_with_pose']} with a pose"
