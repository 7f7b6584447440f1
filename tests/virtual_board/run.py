#!/usr/bin/env python3
"""Boots the virtual board and runs its named tests. run.py BUILD-FOLDER ARM64-IMAGE-FOLDER

Never a latency or a rate: the emulated machine is slow and its USB comes in bursts. Each test says what it saw."""
import json, os, re, shutil, signal, socket, subprocess, sys, time

native, image = sys.argv[1:3]
only = sys.argv[3:]
work = os.path.join(image, 'run')
rows = []


class Failure(Exception):
    pass


def require(held, sentence):
    if not held:
        raise Failure(sentence)


class Monitor:
    """QEMU's machine protocol and the line by which the pedal is pressed."""

    def __init__(self, folder):
        self.machine = self.connect(os.path.join(folder, 'qmp.sock')).makefile('rw')
        self.machine.readline()
        self.say('qmp_capabilities')
        tree = self.say('human-monitor-command', **{'command-line': 'info qom-tree'})['return']
        found = re.search(r'/(device\[\d+\]) \(pl061\)', tree)
        require(found, 'QEMU has no PL061')
        self.chip = '/machine/unattached/' + found.group(1)
        self.test = self.connect(os.path.join(folder, 'qtest.sock'))

    @staticmethod
    def connect(path):
        for _ in range(600):
            try:
                s = socket.socket(socket.AF_UNIX)
                s.connect(path)
                return s
            except OSError:
                time.sleep(0.1)
        raise Failure(path + ' is not there')

    def say(self, command, **arguments):
        self.machine.write(json.dumps({'execute': command, 'arguments': arguments}) + '\n')
        self.machine.flush()
        while True:
            answer = json.loads(self.machine.readline())
            if 'return' in answer or 'error' in answer:
                return answer

    def line(self, number, level):
        """Of the pedal's chip, from outside."""
        self.test.sendall(f'set_irq_in {self.chip} unnamed-gpio-in {number} {int(level)}\n'.encode())
        answer = self.test.recv(4096).decode()
        require(answer.startswith("OK"), f"the pedal cannot be moved: {answer}")


class Usb:
    def __init__(self, folder, product='ff20'):
        self.process = subprocess.Popen(
            [os.path.join(native, 'bin/virtual-usb'), 'vessels', product,
             os.path.join(folder, 'tracker.sock'), os.path.join(folder, 'video.sock')],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def say(self, word):
        self.process.stdin.write(word + '\n')
        self.process.stdin.flush()
        require(self.process.stdout.readline().strip() == word, 'the USB devices are gone')

    def stop(self):
        try:
            self.process.stdin.close()
            self.process.wait(5)
        except (OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()


class Board:
    """One boot. The data disk outlives it."""

    def __init__(self, product='ff20', hold_at_boot=False):
        self.share = os.path.join(work, 'share')
        shutil.rmtree(self.share, ignore_errors=True)
        for name in ('todo', 'done', 'out'):
            os.makedirs(os.path.join(self.share, name))
        self.jobs = 0
        self.usb = Usb(work, product)
        for name in ('tracker.sock', 'video.sock'):
            for _ in range(100):
                if os.path.exists(os.path.join(work, name)):
                    break
                time.sleep(0.1)
        p = lambda name: os.path.join(work, name)
        self.console = open(p('console.log'), 'wb')
        self.qemu = subprocess.Popen(
            ['qemu-system-aarch64', '-M', 'virt,gic-version=3', '-cpu', 'cortex-a72', '-smp', '2', '-m', '1024',
             '-accel', 'tcg,thread=multi', '-nographic', '-no-reboot', '-nic', 'none',
             '-kernel', os.path.join(image, 'vmlinuz'), '-initrd', os.path.join(image, 'initrd.gz'),
             '-dtb', os.path.join(image, 'virtual.dtb'), '-append', 'console=ttyAMA0 quiet panic=-1',
             '-drive', f'if=none,id=system,file={image}/system.squashfs,format=raw,readonly=on',
             '-device', 'virtio-blk-pci,drive=system',
             '-drive', f'if=none,id=data,file={p("data.ext4")},format=raw,cache=writethrough',
             '-device', 'virtio-blk-pci,drive=data',
             '-fsdev', f'local,id=share,path={self.share},security_model=none',
             '-device', 'virtio-9p-pci,fsdev=share,mount_tag=share',
             '-device', 'virtio-gpu-pci', '-device', 'qemu-xhci,id=xhci',
             '-chardev', f'socket,id=tracker,path={p("tracker.sock")},reconnect=1',
             '-device', 'usb-redir,chardev=tracker,bus=xhci.0',
             '-chardev', f'socket,id=video,path={p("video.sock")},reconnect=1',
             '-device', 'usb-redir,chardev=video,bus=xhci.0',
             '-qmp', f'unix:{p("qmp.sock")},server=on,wait=off',
             '-qtest', f'unix:{p("qtest.sock")},server=on,wait=off', '-qtest-log', '/dev/null'],
            stdin=subprocess.DEVNULL, stdout=self.console, stderr=subprocess.STDOUT)
        try:
            self.monitor = Monitor(work)
            if hold_at_boot:
                self.monitor.line(0, True)
            self.wait_for(os.path.join(self.share, 'done/up'), 240, 'the board to boot')
        except Failure:
            self.off(cut=True)
            raise

    def wait_for(self, path, seconds, what):
        until = time.monotonic() + seconds
        while not os.path.exists(path):
            require(self.qemu.poll() is None, f'QEMU ended while waiting for {what}')
            require(time.monotonic() < until, f'{what}: not within {seconds} s')
            time.sleep(0.1)

    def begin(self, script):
        self.jobs += 1
        part = os.path.join(self.share, f'todo/{self.jobs}.part')
        with open(part, 'w') as f:
            f.write(script)
        os.rename(part, os.path.join(self.share, f'todo/{self.jobs}.sh'))
        return self.jobs

    def log(self, job):
        try:
            return open(os.path.join(self.share, f'done/{job}.log'), errors='replace').read()
        except OSError:
            return ''

    def end(self, job, seconds):
        self.wait_for(os.path.join(self.share, f'done/{job}.rc'), seconds, f'job {job}: {self.log(job)[-300:]}')
        return int(open(os.path.join(self.share, f'done/{job}.rc')).read()), self.log(job)

    def run(self, script, seconds=60):
        return self.end(self.begin(script), seconds)

    def said(self, job, pattern, seconds):
        until = time.monotonic() + seconds
        while not re.search(pattern, self.log(job)):
            require(time.monotonic() < until, f'{pattern!r} was not said within {seconds} s: {self.log(job)[-300:]}')
            require(not os.path.exists(os.path.join(self.share, f'done/{job}.rc')), f'ended too early: {self.log(job)[-300:]}')
            time.sleep(0.1)

    # A sweep: the foot goes down and the hand along, and the foot comes up.
    def press(self):
        self.usb.say('press')
        self.monitor.line(0, True)

    def release(self):
        self.monitor.line(0, False)

    def off(self, cut=False):
        if not cut and self.qemu.poll() is None:
            self.begin('sync; poweroff -f')
            try:
                self.qemu.wait(20)
            except subprocess.TimeoutExpired:
                pass
        if self.qemu.poll() is None:
            self.qemu.send_signal(signal.SIGKILL)
        self.qemu.wait()
        self.usb.stop()
        self.console.close()


def examine(board, name, during, seconds=8.0, bounce=False):
    """One scripted examination with the real pedal; `during` happens in the middle of the sweep."""
    script = '\n'.join(['await live 90', 'wait 3', 'await recording 90', 'await review 90', 'render thin.png', ''])
    with open(os.path.join(board.share, f'{name}.script'), 'w') as f:
        f.write(script)
    job = board.begin(f'cd /data && rm -rf /data/{name} && sonoband --board virtual --headless --script /share/{name}.script '
                      f'--out /data/{name} --exams /data/exams-{name}; rc=$?; cp -r /data/{name} /data/exams-{name} /share/out/; exit $rc')
    # When the cart is ready cannot be seen from here, so the foot goes down and up until the script has had its sweep.
    done = os.path.join(board.share, f'done/{job}.rc')
    presses = 0
    until = time.monotonic() + 240
    while not os.path.exists(done) and time.monotonic() < until:
        time.sleep(5)
        if bounce:
            for level in (1, 0, 1, 0, 1, 0):
                board.monitor.line(0, level)
                time.sleep(0.002)
        board.press()
        presses += 1
        time.sleep(seconds / 2)
        during()
        time.sleep(seconds / 2)
        board.release()
    code, log = board.end(job, 240)
    require(code == 0, f'the examination ended with {code}: {log[-400:]}')
    summary = json.load(open(os.path.join(board.share, f'out/{name}/summary.json')))
    summary["presses"] = presses
    return summary, log


def test(name):
    def wrap(function):
        tests.append((name, function))
        return function
    return wrap


tests = []


LOSSES = ('lost_bad_size', 'lost_bad_format', 'lost_bad_stamp', 'lost_late', 'lost_ring_full', 'device_gap',
          'poses_overrun', 'pedal_overrun', 'presses_refused')


def lost(summary):
    """What the cart or a device lost, by cause."""
    return {k: v for k, v in summary['ledger'].items() if v and k in LOSSES}


def swept(summary):
    return [s for s in summary['sweeps'] if s['frames'] > 0]


@test('boots, and --check finds every device')
def check(board):
    code, log = board.run('sonoband --board virtual --check', 60)
    for device in ('tracker', 'video', 'pedal', 'display'):
        require(re.search(rf'^found +{device}', log, re.M), f'{device} is not found: {log}')
    require(code == 0, f'--check ended with {code}: {log}')
    return re.search(r'found +tracker +(.*)', log).group(1)


@test('a sweep by the pedal is tracked, rendered and saved, and its exam exports natively')
def sweep(board):
    summary, _ = examine(board, 'sweep', lambda: None)
    require(swept(summary), f'no sweep: {summary}')
    frames = swept(summary)[0]['frames_with_pose']
    require(frames >= 3, f'only {frames} frames have a pose')
    require(not lost(summary), f'frames were lost: {lost(summary)}')
    out = os.path.join(board.share, 'out')
    tool = os.path.join(native, 'bin/sonoband-tool')
    exams = [f for f in os.listdir(os.path.join(out, 'exams-sweep')) if f.endswith('.exam')]
    require(exams, f"no exam was saved: {os.listdir(os.path.join(out, 'exams-sweep'))}")
    exam = os.path.join(out, 'exams-sweep', exams[0])
    exported = subprocess.run([tool, 'export', exam, '--to', os.path.join(work, 'exported')], capture_output=True, text=True)
    require(exported.returncode == 0, f'the exam cannot be read natively: {exported.stderr[-300:]}')
    return f'{frames} frames'


@test('pedal bounce is one press')
def bounce(board):
    summary, _ = examine(board, 'bounce', lambda: None, bounce=True)
    require(1 <= len(summary['sweeps']) <= summary['presses'], f"{len(summary['sweeps'])} sweeps of {summary['presses']} presses")
    return f"{swept(summary)[0]['frames']} frames"


@test('tracker unplugged in mid-sweep, and back')
def unplug(board):
    def away():
        board.usb.say('unplug-tracker')
        time.sleep(3)
        board.usb.say('plug-tracker')
        time.sleep(8)
    summary, _ = examine(board, 'unplug', away, seconds=10)
    require(swept(summary), f'no sweep: {summary}')
    s = swept(summary)[0]
    require(s['frames_with_pose'] >= 2, f'only {s["frames_with_pose"]} frames have a pose')
    require(s['frames_with_pose'] < s['frames'], 'no frame is without a pose, though the tracker was away')
    return f"{s['frames']} frames, {s['frames_with_pose']} with a pose"


@test('video stalls and resumes')
def stall(board):
    def still():
        board.usb.say('stall-video')
        time.sleep(3)
        board.usb.say('resume-video')
        time.sleep(4)
    summary, _ = examine(board, 'stall', still, seconds=8)
    require(swept(summary), f'no sweep: {summary}')
    return f"{swept(summary)[0]['frames']} frames"


def press_during_boot():
    """A pedal that is down when the cart starts records nothing until it has come up once."""
    board = Board(hold_at_boot=True)
    try:
        with open(os.path.join(board.share, 'held.script'), 'w') as f:
            f.write('await live 90\nwait 5\n')
        job = board.begin('cd /data && sonoband --board virtual --headless --script /share/held.script --out /data/held --exams ""; rc=$?; cp -r /data/held /share/out/; exit $rc')
        code, log = board.end(job, 180)
        require(code == 0, f'ended with {code}: {log[-300:]}')
        summary = json.load(open(os.path.join(board.share, 'out/held/summary.json')))
        require(not summary['sweeps'], f'it recorded: {summary}')
        return 'nothing recorded'
    finally:
        board.off()


def wrong_device():
    board = Board(product='cf01')
    try:
        code, log = board.run('sonoband --board virtual --check', 60)
        require(code == 1, f'--check ended with {code}: {log}')
        require('unknown Polhemus device: 0f44:cf01' in log, log)
        return 'named as unknown, exit code 1'
    finally:
        board.off()


def viper():
    board = Board(product='bf01')
    try:
        code, log = board.run('sonoband --board virtual --check', 60)
        require('VIPER on USB' in log and code == 0, log)
        summary, _ = examine(board, 'viper', lambda: None, seconds=6)
        require(swept(summary) and swept(summary)[0]['frames_with_pose'] >= 3, f'no tracked sweep: {summary}')
        return f"{swept(summary)[0]['frames_with_pose']} frames"
    finally:
        board.off()


def power_cut():
    """QEMU is killed while the cart records; the exam is there after the next boot, and the cart runs."""
    board = Board()
    with open(os.path.join(board.share, 'cut.script'), 'w') as f:
        f.write('await live 90\nawait recording 90\nawait review 90\n')
    board.begin('cd /data && rm -rf /data/exams-cut && sonoband --board virtual --headless --script /share/cut.script --out /data/cut --exams /data/exams-cut')
    time.sleep(15)
    board.press()
    time.sleep(6)
    board.off(cut=True)
    board = Board()
    try:
        code, log = board.run('ls -lR /data/exams-cut; sonoband --board sim --headless --script /dev/null --out /tmp/x --exams /data/exams-cut; rc=$?; cp -r /data/exams-cut /share/out/; exit $rc', 120)
        require(code == 0, f'after the cut the cart ended with {code}: {log[-400:]}')
        names = [n for _, _, files in os.walk(os.path.join(board.share, 'out/exams-cut')) for n in files]
        require(names, 'nothing of the exam is on the disk')
        recovered = re.search(r'sonoband: (.*)', log)
        return recovered.group(1) if recovered else f'{len(names)} files'
    finally:
        board.off()


def judge(name, function):
    if only and not any(word in name for word in only):
        return
    began = time.monotonic()
    try:
        said, passed = function() or '', True
    except Failure as e:
        said, passed = str(e), False
    except Exception as e:  # a defect of this program is a failure of the test that showed it
        said, passed = f'{type(e).__name__}: {e}', False
    rows.append(passed)
    print(f"{'passed' if passed else 'FAILED'}  {name}  ({time.monotonic() - began:.0f} s)  {said}", flush=True)


def main():
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    disk = os.path.join(work, 'data.ext4')
    with open(disk, 'wb') as f:
        f.truncate(2 << 30)  # more than exams.reserve-mb, or no sweep starts
    subprocess.run(['mke2fs', '-q', '-t', 'ext4', '-F', disk], check=True)
    board = None
    try:
        board = Board()
    except Failure as e:
        rows.append(False)
        print(f'FAILED  boots  {e}', flush=True)
    if board:
        for name, function in tests:
            judge(name, lambda function=function: function(board))
        board.off()
        judge('a pedal held during boot records nothing', press_during_boot)
        judge('a wrong USB device is named', wrong_device)
        judge('a VIPER in place of the LIBERTY', viper)
        judge('power cut while recording, then reboot', power_cut)
    print(f'{sum(rows)} passed, {len(rows) - sum(rows)} failed')
    return 0 if all(rows) else 1


if __name__ == '__main__':
    sys.exit(main())
