"""The emulated board: QEMU, the devices outside it, and the jobs that it does for us.

Never a latency or a rate: the emulated machine is slow and its USB comes in bursts. A time given here is only how long
something is waited for before the test is called failed."""
import json, os, re, shutil, signal, socket, subprocess, time

PATIENCE = 180  # s; a board under another load than ours has needed 60


class Failure(Exception):
    pass


def require(held, sentence):
    if not held:
        raise Failure(sentence)


def wait_for(there, what, seconds=PATIENCE, ended=lambda: None):
    """What `there` gives as soon as that is true. `ended` says why it can never be."""
    until = time.monotonic() + seconds
    while True:
        found = there()
        if found:
            return found
        why = ended()
        require(not why, f'{why} while waiting for {what}')
        require(time.monotonic() < until, f'{what}: not within {seconds} s')
        time.sleep(0.05)


class Machine:
    """QEMU's machine protocol, on `qmp.sock` in a folder."""

    def __init__(self, folder, ended):
        self.machine = self.connect(os.path.join(folder, 'qmp.sock'), ended).makefile('rw')
        self.machine.readline()
        self.say('qmp_capabilities')

    @staticmethod
    def connect(path, ended):
        def connected():
            s = socket.socket(socket.AF_UNIX)
            try:
                s.connect(path)
                return s
            except OSError:
                s.close()
        return wait_for(connected, 'QEMU to listen at ' + path, 60, ended)

    def say(self, command, **arguments):
        self.machine.write(json.dumps({'execute': command, 'arguments': arguments}) + '\n')
        self.machine.flush()
        while True:
            answer = json.loads(self.machine.readline())
            if 'return' in answer or 'error' in answer:
                return answer


class Monitor(Machine):
    """That protocol, and the line by which the pedal is pressed."""

    def __init__(self, folder, ended):
        super().__init__(folder, ended)
        tree = self.say('human-monitor-command', **{'command-line': 'info qom-tree'})['return']
        found = re.search(r'/(device\[\d+\]) \(pl061\)', tree)
        require(found, 'QEMU has no PL061')
        self.chip = '/machine/unattached/' + found.group(1)
        self.test = self.connect(os.path.join(folder, 'qtest.sock'), ended)

    def line(self, number, level):
        """Of the pedal's chip, from outside."""
        self.test.sendall(f'set_irq_in {self.chip} unnamed-gpio-in {number} {int(level)}\n'.encode())
        answer = self.test.recv(4096).decode()
        require(answer.startswith('OK'), f'the pedal cannot be moved: {answer}')


class Usb:
    """The USB devices: a program of ours that QEMU takes them from."""

    def __init__(self, program, folder):
        self.process = subprocess.Popen([program, 'vessels', folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True)
        for name in ('liberty', 'viper', 'stranger', 'video'):
            wait_for(lambda: os.path.exists(os.path.join(folder, name + '.sock')), 'the USB devices', 20)

    def say(self, words):
        self.process.stdin.write(words + '\n')
        self.process.stdin.flush()
        answer = self.process.stdout.readline().strip()
        require(answer == words, f'the USB devices were told {words!r} and said {answer!r}')

    def stop(self):
        try:
            self.process.stdin.close()
            code = self.process.wait(10)
        except (OSError, subprocess.TimeoutExpired):
            self.process.kill()
            code = self.process.wait()
        return code


class Board:
    """One boot, with systemd or with as little as the jobs need. The data disk outlives it. Ends by `off`, or as if the plug
    was pulled by `cut`."""

    def __init__(self, image, work, usb_program, programs, held=False, systemd=False):
        self.work = work
        self.systemd = systemd
        self.share = os.path.join(work, 'share')
        shutil.rmtree(self.share, ignore_errors=True)
        for name in ('todo', 'done', 'out', 'bin'):
            os.makedirs(os.path.join(self.share, name))
        for program in programs:
            shutil.copy(program, os.path.join(self.share, 'bin'))
        self.jobs = 0
        self.usb = Usb(usb_program, work)
        self.console = open(os.path.join(work, 'console.log'), 'ab')
        self.errors = open(os.path.join(work, 'qemu.log'), 'ab')
        self.qemu = subprocess.Popen(self.command(image), stdin=subprocess.DEVNULL, stdout=self.console,
                                     stderr=self.errors)
        try:
            self.monitor = Monitor(work, self.dead)
            self.monitor.line(0, held)
            wait_for(lambda: os.path.exists(os.path.join(self.share, 'done/up')), 'the board to boot', 2 * PATIENCE,
                     self.dead)
        except BaseException:
            self.cut()
            raise

    def command(self, image):
        p = lambda name: os.path.join(self.work, name)
        words = ['qemu-system-aarch64', '-M', 'virt,gic-version=3', '-cpu', 'cortex-a72', '-smp', '2', '-m', '1024',
                 '-accel', 'tcg,thread=multi', '-nographic', '-no-reboot', '-nic', 'none',
                 '-kernel', os.path.join(image, 'vmlinuz'), '-initrd', os.path.join(image, 'initrd.gz'),
                 '-dtb', os.path.join(image, 'virtual.dtb'), '-append', 'console=ttyAMA0 quiet panic=-1' + ' init=/lib/systemd/systemd systemd.unit=board.service' * self.systemd,
                 '-drive', f'if=none,id=system,file={image}/system.squashfs,format=raw,readonly=on',
                 '-device', 'virtio-blk-pci,drive=system',
                 '-drive', f'if=none,id=data,file={p("data.ext4")},format=raw,cache=writethrough',
                 '-device', 'virtio-blk-pci,drive=data',
                 '-fsdev', f'local,id=share,path={self.share},security_model=none',
                 '-device', 'virtio-9p-pci,fsdev=share,mount_tag=share',
                 '-device', 'virtio-gpu-pci', '-device', 'qemu-xhci,id=xhci,p2=8,p3=4',
                 '-qmp', f'unix:{p("qmp.sock")},server=on,wait=off',
                 '-qtest', f'unix:{p("qtest.sock")},server=on,wait=off', '-qtest-log', '/dev/null']
        words += ['-blockdev', f'driver=file,node-name=stick,filename={p("stick.fat")}']  # plugged in by `plug_stick`
        for name in ('liberty', 'viper', 'stranger', 'video'):
            words += ['-chardev', f'socket,id={name},path={p(name + ".sock")},reconnect=1',
                      '-device', f'usb-redir,chardev={name},bus=xhci.0']
        return words

    def dead(self):
        code = self.qemu.poll()
        return None if code is None else f'QEMU ended with {code}'

    # A job is a script that the board runs beside the others.
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

    def code(self, job):
        """How it ended; None while it runs."""
        try:
            return int(open(os.path.join(self.share, f'done/{job}.rc')).read())
        except OSError:
            return None

    def end(self, job):
        wait_for(lambda: self.code(job) is not None, f'job {job} to end: {self.log(job)[-300:]}', ended=self.dead)
        return self.code(job), self.log(job)

    def run(self, script):
        return self.end(self.begin(script))

    # Two fast words of the foot; the hand goes along with the first.
    def press(self):
        self.usb.say('press')
        self.monitor.line(0, True)

    def release(self):
        self.monitor.line(0, False)

    def plug_stick(self):
        answer = self.monitor.say('device_add', driver='usb-storage', drive='stick', id='stick', bus='xhci.0', removable=True)
        require('return' in answer, f'the stick cannot be plugged in: {answer}')
        device = lambda: self.run('ls -d /dev/sd[a-z]')[1].strip()
        return wait_for(lambda: device() if device().startswith('/dev/') else None, 'the kernel to see the stick',
                        ended=self.dead)

    def pull_stick(self):
        self.monitor.say('device_del', id='stick')
        wait_for(lambda: self.run('ls -d /dev/sd[a-z]')[0] != 0, 'the kernel to see the stick go', ended=self.dead)

    def off(self):
        self.begin('sync; poweroff -f')
        code = None
        try:
            code = self.qemu.wait(60)
        except subprocess.TimeoutExpired:
            pass
        self.cut()
        require(code == 0, f'the board did not switch itself off: QEMU ended with {code}')

    def cut(self):
        if self.qemu.poll() is None:
            self.qemu.send_signal(signal.SIGKILL)
        self.qemu.wait()
        code = self.usb.stop()
        self.console.close()
        self.errors.close()
        require(code == 0, f'the USB devices ended with {code}')
