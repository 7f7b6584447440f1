"""What the named tests work with: the board that is on, the cart that runs on it, and the programs of here."""
import collections, json, os, subprocess

from board import Board, require, wait_for
from cart import Cart

guest = lambda name: os.path.join(os.path.dirname(os.path.abspath(__file__)), 'guest', name)

# A named test: `run` takes the bench and gives a sentence, or raises a Failure. `cart`: it needs the cart of this name, and
# takes so many of its sweeps.
Test = collections.namedtuple('Test', 'name cart sweeps run')


def test(name, cart=None, sweeps=1):
    return lambda function: Test(name, cart, sweeps, function)


class Bench:
    """The board that is on, and the cart that runs on it; both are made when a test needs them."""

    def __init__(self, native, arm64, image):
        """Folders: what was built for here and for the board, and the board's system. It works in one of its own."""
        self.native = native
        self.arm64 = arm64
        self.image = image
        self.work = os.path.join(image, 'run')
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
            self.board_ = Board(self.image, self.work, os.path.join(self.native, 'bin/virtual-usb'),
                                [os.path.join(self.arm64, 'bin/virtual-touch'), guest('as-kiosk'), guest('onto-the-stick')], held=self.held, systemd=self.systemd)
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

    def tool(self, *arguments):
        """sonoband-tool of here; what it prints."""
        done = subprocess.run([os.path.join(self.native, 'bin/sonoband-tool'), *arguments], capture_output=True, text=True)
        require(done.returncode == 0, f'sonoband-tool {arguments[0]} ended with {done.returncode}: {done.stderr[-300:]}')
        return done.stdout

    def exam_of(self, folder):
        """From the shared folder."""
        listed = json.loads(self.tool('exams', folder, '--json'))['exams']
        require(len(listed) == 1, f'{len(listed)} exams in {folder}')
        return listed[0]
