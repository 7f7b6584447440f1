"""What is stored outlives a power cut, and leaves the board on a stick."""
import json, os, shutil, subprocess

from bench import test
from board import require, wait_for
from cart import FRAMES, losses


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
    exam = bench.exam_of(os.path.join(board.share, 'out', name, 'exams'))
    bench.tool('verify', exam['path'])
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
        again.run(bench)
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
    here = os.path.join(bench.work, 'stick-here')
    bench.tool('export', os.path.join(board.share, 'out', exam), '--to', here, '--format', 'mha', '--sweep', '1')
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
        size = same_files(bench, os.path.join(bench.work, 'stick.fat'), here)
    return f'{len(os.listdir(here))} files, {size / 1e6:.1f} MB, the same bytes as written here, plugged in before and after the service started'


def same_files(bench, stick, here):
    """Bytes of what is on a stick in `taken`, the same as in the folder `here`; takes it from the stick."""
    taken = os.path.join(bench.work, 'taken')
    shutil.rmtree(taken, ignore_errors=True)
    for words in (('mcopy', '-s', '-i', stick, '::/taken', bench.work), ('mdeltree', '-i', stick, '::/taken')):
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
