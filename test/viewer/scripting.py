"""The page's modules without the page: in Node.js, or in the browser where there is none."""

import json
import shutil
import subprocess

from circle_bounce_ros.installation import child_environment
from circle_bounce_ros.viewer.server import PAGE

# Reads an expression and an argument a line, answers with a result or an error a line. As much of a document as the
# modules touch that are no drawing: elements that keep what is written to them.
HOST = """
import { createInterface } from 'node:readline';
const elements = {};
const element = () => ({ value: '', textContent: '', hidden: false, setAttribute() {} });
globalThis.window = globalThis;
globalThis.document = { activeElement: null, getElementById: (id) => elements[id] ??= element() };
globalThis.requestAnimationFrame = (then) => setTimeout(() => then(performance.now()), 5);
const load = (name) => import(`./${name}`);
for await (const line of createInterface({ input: process.stdin })) {
  const [expression, argument] = JSON.parse(line);
  let answer;
  try {
    answer = { result: (await (0, eval)(expression)(load, argument)) ?? null };
  } catch (error) {
    answer = { error: error.message };
  }
  process.stdout.write(`${JSON.stringify(answer)}\\n`);
}
"""


class ScriptError(Exception):
    """What JavaScript has thrown."""


class NodeScripts:
    """A process of Node.js with the page's modules."""

    def __init__(self, folder):
        shutil.copytree(PAGE, folder, dirs_exist_ok=True)
        (folder / 'package.json').write_text('{"type": "module"}')
        (folder / 'host.mjs').write_text(HOST)
        self._process = subprocess.Popen(
            [shutil.which('node'), 'host.mjs'],
            cwd=folder,
            env=child_environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def evaluate(self, expression, argument=None):
        """Return what `(load, argument) => ...` returns or resolves to; `load('lesson.js')` imports a module."""
        self._process.stdin.write(f'{json.dumps([expression, argument])}\n')
        self._process.stdin.flush()
        answer = json.loads(self._process.stdout.readline())
        if 'error' in answer:
            raise ScriptError(answer['error'])
        return answer['result']

    def close(self):
        self._process.communicate()


class BrowserScripts:
    """The same in a page that shows nothing."""

    def __init__(self, page):
        self._page = page

    def evaluate(self, expression, argument=None):
        answer = self._page.evaluate(
            f"""async (argument) => {{
              try {{
                return {{ result: await ({expression})((name) => import(`/${{name}}`), argument) }};
              }} catch (error) {{
                return {{ error: error.message }};
              }}
            }}""",
            argument,
        )
        if 'error' in answer:
            raise ScriptError(answer['error'])
        return answer['result']
