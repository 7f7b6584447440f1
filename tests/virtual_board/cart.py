"""A cart that runs on the board and is watched from outside: its script says every state, sweep and picture."""
import json, os

from board import PATIENCE, Failure, require, wait_for

# Frames that a sweep here has at least: enough for a picture, and at five a second soon there.
FRAMES = 12

# What the cart or a device lost, by cause. A picture shown twice is no loss.
LOSSES = ('lost_bad_size', 'lost_bad_format', 'lost_bad_stamp', 'lost_late', 'lost_ring_full', 'lost_stopped', 'device_gap',
          'source_resets', 'poses_overrun', 'pedal_overrun', 'presses_refused')


def losses(sweep):
    return {k: v for k, v in sweep['ledger'].items() if v and k in LOSSES}


class Cart:
    """Takes `sweeps` sweeps by the pedal, paints a band of each, and ends. `options`: more of them, for its command line."""

    def __init__(self, board, name, sweeps, options=''):
        self.board = board
        self.folder = '/data/' + name
        script = ['watch', 'await live 300']
        for n in range(1, sweeps + 1):
            script += ['await recording 900', 'await review 900', 'wait 2',
                       f'render band{n}.png view=level thickness-mm=3 compounding=max']
        with open(os.path.join(board.share, name + '.script'), 'w') as f:
            f.write('\n'.join(script) + '\n')
        self.planned = sweeps
        self.sweeps = 0
        self.job = board.begin(f'mkdir -p {self.folder} && exec sonoband --board virtual --headless --script /share/{name}.script '
                               f'--out {self.folder}/out --exams {self.folder}/exams {options}')

    def ended(self):
        code = self.board.code(self.job)
        if code is not None:
            return f'the cart ended with {code}: {self.board.log(self.job)[-300:]}'
        return self.board.dead()

    def lines(self, key):
        """What was said that has this key, oldest first."""
        said = []
        for line in self.board.log(self.job).split('\n')[:-1]:  # the last may be half written
            if line.startswith('{'):
                try:
                    said.append(json.loads(line))
                except ValueError:
                    raise Failure(f'the cart wrote half a line: {line}')
        return [line for line in said if key in line]

    def now(self):
        states = self.lines('state')
        return states[-1] if states else {}

    def wait(self, holds, what, seconds=PATIENCE):
        def there():
            now = self.now()
            return now if now and holds(now) else None
        try:
            return wait_for(there, what, seconds, self.ended)
        except Failure as e:
            raise Failure(f'{e}; the cart says {json.dumps(self.now())}')

    def ready(self):
        """A tracked sweep can begin."""
        self.board.release()
        self.wait(lambda s: s['tracker'] == 'running' and s['video'] == 'running' and s['readings'] > 0, 'tracker and video')
        return self.wait(lambda s: s['armed'] and not s['down'], 'the pedal to be up')

    def frames(self, more):
        """Waits until so many more are saved."""
        enough = self.now()['saved'] + more
        return self.wait(lambda s: s['saved'] >= enough, f'{more} more frames')

    def account(self):
        """Of the sweep that has ended."""
        return wait_for(lambda: self.lines('sweep'), 'the account of the sweep', ended=self.ended)[-1]['sweep']

    def swept(self):
        """After a sweep: its account, once its band is painted and the script is ready for the next."""
        self.sweeps += 1
        wait_for(lambda: len(self.lines('picture')) >= self.sweeps, f'the band of sweep {self.sweeps}', ended=lambda: None if
                 len(self.lines('picture')) >= self.sweeps else self.ended())
        said = self.lines('sweep')
        require(len(said) == self.sweeps, f'{len(said)} sweeps of {self.sweeps} presses')
        return said[-1]['sweep']

    def sweep(self, during=lambda: None):
        self.take(during)
        return self.swept()

    def take(self, during=lambda: None):
        """A sweep from press to release."""
        self.ready()
        self.board.press()
        self.wait(lambda s: s['state'] == 'recording', 'a press to record')
        self.frames(FRAMES)
        during()
        self.board.release()
        self.wait(lambda s: s['state'] == 'review', 'the release to end the sweep')

    def end(self):
        code, log = self.board.end(self.job)
        require(code == 0, f'the cart ended with {code}: {log[-300:]}')

    def kill(self):
        self.board.release()
        if self.board.code(self.job) is None:
            self.board.run('killall -9 sonoband')
