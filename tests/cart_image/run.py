#!/usr/bin/python3
"""Looks at the card of a Raspberry Pi cart, then boots its system on an emulated arm64 machine. run.py IMAGE NATIVE-TOOL
The firmware and the Raspberry Pi itself are not emulated: kernel, initrd and root are the card's, the machine is QEMU's."""
import json, os, re, shutil, subprocess, sys, time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '../virtual_board'))
from board import Failure, Machine, require, wait_for

image, tool = sys.argv[1:3]
work = os.path.join(os.path.dirname(image), 'check')
share = os.path.join(work, 'share')
PATIENCE = 1800  # s, for a whole boot with X under emulation, on a machine that is busy otherwise
tests = []


def test(name):
    return lambda function: tests.append((name, function)) or function


def run(*words, **more):
    done = subprocess.run(words, capture_output=True, text=True, **more)
    require(done.returncode == 0, f'{words[0]} ended with {done.returncode}: {done.stderr[-300:]}')
    return done.stdout


def partitions():
    return json.loads(run('sfdisk', '--json', image))['partitiontable']['partitions']


def at(name):
    """Offset of the file system of this label, bytes."""
    for part in partitions():
        offset = part['start'] * 512
        if run('blkid', '-p', '-O', str(offset), '-o', 'value', '-s', 'LABEL', image).strip() == name:
            return offset
    raise Failure(f'no file system is called {name}')


def boot_file(name):
    to = os.path.join(work, os.path.basename(name))
    run('mcopy', '-n', '-i', f'{image}@@{at("SONOBOOT")}', '::/' + name, to)
    return to


def root_file(path):
    return run('debugfs', '-R', f'cat {path}', f'{image}?offset={at("SONOBAND-ROOT")}')


def kernel_words():
    """What the firmware hands to the kernel."""
    return open(boot_file('cmdline.txt')).read().split()


@test('three partitions that any EEPROM reads, the data last, where it can grow')
def table(_):
    require(json.loads(run('sfdisk', '--json', image))['partitiontable']['label'] == 'dos', 'the table is no MBR')
    parts = partitions()
    require([p['type'] for p in parts] == ['c', '83', '83'], str(parts))
    names = ['SONOBOOT', 'SONOBAND-ROOT', 'SONOBAND-DATA']
    require([at(n) for n in names] == [p['start'] * 512 for p in parts], 'they have other labels')
    return ', '.join(f"{n} {p['size'] * 512 >> 20} MB" for n, p in zip(names, parts))


@test('the firmware finds kernel, initrd, device trees and the settings of this cart')
def firmware(_):
    config = open(boot_file('config.txt')).read()
    require('dtoverlay=footswitch' in config, config)
    kernel = re.findall(r'^kernel=(\S+)', config, re.M)[-1]
    initrd = re.findall(r'^initramfs (\S+)', config, re.M)[-1]
    for name in (kernel, initrd, 'start4.elf', 'fixup4.dat', 'bcm2711-rpi-4-b.dtb', 'overlays/footswitch.dtbo', 'sonoband/board'):
        require(os.path.getsize(boot_file(name)) > 0, f'{name} is empty')
    words = kernel_words()
    require('root=LABEL=SONOBAND-ROOT' in words, str(words))
    require([w for w in words if w in ('ro', 'rw')][-1] == 'ro', f'the root is written to: {words}')
    require(not any(w.startswith('cma=') for w in words), f'a Raspberry Pi 4 may not start with {words}')
    os.replace(os.path.join(work, kernel), os.path.join(work, 'kernel'))
    os.replace(os.path.join(work, initrd), os.path.join(work, 'initrd'))
    return kernel


@test("the pedal's overlay fits the device tree of this kernel")
def overlay(_):
    merged = os.path.join(work, 'merged.dtb')
    tree = boot_file('bcm2711-rpi-4-b.dtb')
    run('fdtoverlay', '-i', tree, '-o', merged, boot_file('overlays/footswitch.dtbo'))
    gpio = '/soc/gpio@7e200000'
    require('pinctrl-0' not in run('fdtget', '-p', tree, gpio).split(), 'the overlay takes away pins that the tree sets')
    require(run('fdtget', '-t', 'i', merged, gpio + '/footswitch_pins', 'brcm,pins').split() == ['17', '27'], 'other pins')
    require(run('fdtget', '-t', 'i', merged, gpio + '/footswitch_pins', 'brcm,pull').split() == ['2', '2'], 'other pulls')
    names = run('fdtget', merged, gpio, 'gpio-line-names').split()
    require('GPIO17' in names and 'GPIO27' in names, f'the lines are called {names}')
    return 'GPIO17 and GPIO27, pulled up'


@test('the root has the cart, and a table that never writes to it')
def root(_):
    status = root_file('/var/lib/dpkg/status')
    package = next(p for p in status.split('\n\n') if p.startswith('Package: sonoband\n'))
    require('Status: install ok installed' in package and 'Architecture: arm64' in package, package)
    require(re.search(r'^LABEL=SONOBAND-ROOT\s+/\s+ext4\s+ro', root_file('/etc/fstab'), re.M), root_file('/etc/fstab'))
    require(root_file('/etc/machine-id') == '', 'every card would be the same machine')
    unit = root_file('/usr/lib/systemd/system/sonoband.service')
    require('Type=notify' in unit, unit)
    return re.search(r'^Version: (.*)', package, re.M).group(1)


def journal():
    """The end of what the system wrote down."""
    return '\n' + open(os.path.join(share, 'journal'), errors='replace').read()[-2000:]


def command():
    p = lambda name: os.path.join(work, name)
    start = "mkdir -p /run/check && modprobe 9pnet_virtio && mount -t 9p -o trans=virtio,version=9p2000.L check /run/check && exec sh /run/check/guest-check"
    return ['qemu-system-aarch64', '-M', 'virt,gic-version=3', '-cpu', 'cortex-a72', '-smp', '2', '-m', '1536', '-accel', 'tcg,thread=multi',
            '-display', 'none', '-serial', f'file:{p("console.log")}', '-no-reboot', '-nic', 'none', '-kernel', p('kernel'), '-initrd', p('initrd'),
            '-append', f'{" ".join(w for w in kernel_words() if not w.startswith("console="))} console=ttyAMA0 systemd.default_timeout_start_sec=900 systemd.run="/bin/sh -c \'{start}\'" systemd.run_success_action=poweroff systemd.run_failure_action=poweroff',
            '-drive', f'if=none,id=card,file={p("card.qcow2")},format=qcow2', '-device', 'virtio-blk-pci,drive=card',
            '-drive', f'if=none,id=stick,file={p("stick.fat")},format=raw', '-device', 'qemu-xhci,id=xhci', '-device', 'usb-storage,drive=stick,removable=on',
            '-fsdev', f'local,id=check,path={share},security_model=none', '-device', 'virtio-9p-pci,fsdev=check,mount_tag=check',
            '-device', 'virtio-gpu-pci,xres=1280,yres=800', '-device', 'usb-tablet', '-device', 'usb-kbd', '-qmp', f'unix:{p("qmp.sock")},server=on,wait=off']


class Boot:
    """The card in a machine; what its system says of itself."""

    def __init__(self):
        for name in ('card.qcow2', 'stick.fat', 'qmp.sock'):
            if os.path.exists(os.path.join(work, name)):
                os.remove(os.path.join(work, name))
        # A card of four times the size; what is written to it goes elsewhere.
        grown = max(8 << 30, 2 * os.path.getsize(image))
        run('qemu-img', 'create', '-q', '-f', 'qcow2', '-b', os.path.abspath(image), '-F', 'raw', os.path.join(work, 'card.qcow2'), str(grown))
        with open(os.path.join(work, 'stick.fat'), 'wb') as f:
            f.truncate(64 << 20)
        run('mkfs.vfat', '-n', 'ULTRASOUND', os.path.join(work, 'stick.fat'))
        here = os.path.dirname(os.path.abspath(__file__))
        for name in ('guest-check', 'short-script', '../virtual_board/guest/as-kiosk', '../virtual_board/guest/onto-the-stick'):
            shutil.copy(os.path.join(here, name), share)
        self.qemu = subprocess.Popen(command(), stdin=subprocess.DEVNULL, stderr=open(os.path.join(work, 'qemu.log'), 'w'))
        try:
            machine = Machine(work, self.dead)
            self.wait('limits')
            self.screen(machine)
            self.done('seen')
            self.wait('again')
            self.screen(machine)
            space = {'type': 'key', 'data': {'down': True, 'key': {'type': 'qcode', 'data': 'spc'}}}
            pressed = machine.say('input-send-event', events=[space])
            require('error' not in pressed, str(pressed))
            self.done('held')
            self.wait('end')
        finally:
            self.end()

    def screen(self, machine):
        """Waits for a picture of the cart; `screen.png`."""
        from PIL import Image
        path = os.path.join(work, 'screen.png')

        def shown():
            answer = machine.say('screendump', filename=path, format='png')
            require('error' not in answer, str(answer))
            colours = Image.open(path).convert('RGB').getcolors(1 << 24)
            time.sleep(5)
            return len(colours) > 100  # a console has a few

        wait_for(shown, 'the cart to be seen', 600, self.dead)

    @staticmethod
    def done(name):
        """Tells the system's script that something was done outside."""
        open(os.path.join(share, name), 'w').close()

    def dead(self):
        return None if self.qemu.poll() is None else f'QEMU ended with {self.qemu.returncode}'

    def said(self):
        try:
            lines = open(os.path.join(share, 'said')).read().split('\n')
        except OSError:
            return {}
        return dict((line.split(' ', 1) + [''])[:2] for line in lines if line)

    def wait(self, name):
        wait_for(lambda: name in self.said(), f'the system to say {name!r}, after {list(self.said())}', PATIENCE, self.dead)

    def end(self):
        for name in ('seen', 'held'):
            self.done(name)
        try:
            self.qemu.wait(120)
        except subprocess.TimeoutExpired:
            self.qemu.kill()
            self.qemu.wait()


@test('it boots: systemd, a read-only root, data that took the whole card')
def boots(bench):
    bench['boot'] = boot = Boot()
    said = boot.said()
    require(re.match(r'ro\b', said['root']) and re.match(r'rw\b', said['data']), str(said))
    require('written' not in said, 'somebody could write to /etc')
    require(int(said['data-bytes']) > 4 << 30, f"the data partition has {said['data-bytes']} bytes")
    return f"data {int(said['data-bytes']) / 1e9:.1f} GB"


@test('the kiosk runs: X and the cart, ready, at real-time priority, its memory locked')
def kiosk(bench):
    said = bench['boot'].said()
    require(said['kiosk'] == 'active, restarted 0 times, says: Acquisition runs.', said['kiosk'] + journal())
    require(said['limits'].split() == ['unlimited', '50'], said['limits'])
    return 'seen on its screen'


@test('a kiosk that crashed, or hangs, is there again')
def again(bench):
    said = bench['boot'].said()
    require(said['crashed'] == 'active, restarted 1 times', said['crashed'] + journal())
    require(said['again'] == 'active, restarted 2 times', said['again'] + journal())
    return 'twice'


@test('a kiosk that is stopped while it records saves the sweep')
def stopped(bench):
    said = bench['boot'].said()
    require(said['stopped'] == 'success' and said['verified'] == '0', str(said) + journal())
    exams = json.load(open(os.path.join(share, 'saved')))['exams']
    require([(e['sweeps'], e['closed'], e['damage']) for e in exams] == [(1, True, '')] and exams[0]['frames'] > 0, str(exams))
    return f"{exams[0]['frames']} frames"


@test("a stick is mounted for the cart's user, an exam goes onto it from the kiosk's unit, which lets it go and can do no more")
def stick(bench):
    said = bench['boot'].said()
    require('uid=' in said['stick'] and 'nosuid' in said['stick'], said['stick'])
    require(said.get('examination') == '0' and said.get('export') == '0',
            str(said) + ''.join(open(os.path.join(share, n)).read()[-500:] for n in ('examination', 'export') if os.path.exists(os.path.join(share, n))))
    require(said['still-mounted'] == '0', 'it is still mounted')
    log = open(os.path.join(share, 'export')).read()
    places = json.JSONDecoder().raw_decode(log[log.index('{'):])[0]['places']
    require([p['label'] for p in places] == ['ULTRASOUND'], str(places))
    run('mcopy', '-s', '-n', '-i', os.path.join(work, 'stick.fat'), '::/taken', work)
    exam = next(f for f in os.listdir(share) if f.endswith('.exam'))
    here = os.path.join(work, 'here')
    run(tool, 'export', os.path.join(share, exam), '--to', here, '--format', 'mha', '--sweep', '1')
    names = sorted(os.listdir(here))
    require(names and names == sorted(os.listdir(os.path.join(work, 'taken'))), f'{names} here')
    for name in names:
        require(open(os.path.join(here, name), 'rb').read() == open(os.path.join(work, 'taken', name), 'rb').read(), f'{name} differs')
    return f"{len(names)} files, the same bytes as written here; {said['stick'].split()[0]}"


@test('no unit of the system failed')
def units(bench):
    require('end' in bench['boot'].said(), 'it did not come that far')
    failed = open(os.path.join(share, 'failed-units')).read().strip()
    require(failed == '', failed)


def main():
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(share)
    bench, passed = {}, 0
    for name, function in tests:
        began = time.monotonic()
        try:
            said, good = function(bench) or '', True
        except Failure as e:
            said, good = str(e), False
        except Exception as e:  # a defect of this program is a failure of the test that showed it
            said, good = f'{type(e).__name__}: {e}', False
        print(f"{'passed' if good else 'FAILED'}  {name}  ({time.monotonic() - began:.0f} s)  {said}", flush=True)
        passed += good
    print(f'{passed} passed, {len(tests) - passed} failed')
    return 0 if passed == len(tests) else 1


if __name__ == '__main__':
    sys.exit(main())
