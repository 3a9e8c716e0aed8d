"""Pixels of the page's two canvases, and where circles are on them."""

import base64
import math

import numpy as np

# Read back right after drawing: later the picture is gone. Rows of WebGL come from the bottom, those of a 2-D canvas
# from the top.
READ_BACK = """
() => new Promise((resolve) => {
  const text = (bytes) => {
    let all = '';
    for (let i = 0; i < bytes.length; i += 32768) all += String.fromCharCode(...bytes.subarray(i, i + 32768));
    return btoa(all);
  };
  bounce.afterDraw = (app) => {
    bounce.afterDraw = null;
    const { view: { camera, ratio, canvases: [canvas] }, picture: { gl }, looks, world } = app;
    const { width, height } = canvas;
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    resolve({ width, height, ratio, scale: camera.scale, x: camera.x, y: camera.y,
              stamp: world.cloud.stamp, look: looks.colours, pixels: text(pixels) });
  };
  bounce.isDirty = true;
})
"""
READ_CANVAS = """
(name) => {
  const c = document.getElementById(name);
  const { data, width, height } = c.getContext('2d').getImageData(0, 0, c.width, c.height);
  let all = '';
  for (let i = 0; i < data.length; i += 32768) all += String.fromCharCode(...data.subarray(i, i + 32768));
  return { width, height, pixels: btoa(all) };
}
"""


class Picture:
    """
    What was drawn.

    Attributes
    ----------
    pixels : (height, width, 3) int array
        From the top.
    stamp : str
        Of the message that was drawn.
    look : dict
        The page's colours.

    """

    def __init__(self, page):
        read = page.evaluate(READ_BACK)
        shape = read['height'], read['width'], 4
        bytes_ = np.frombuffer(base64.b64decode(read['pixels']), np.uint8)
        self.pixels = bytes_.reshape(shape)[::-1, :, :3].astype(int)
        self.stamp = read['stamp']
        self.look = read['look']
        self.x, self.y = read['x'], read['y']
        self.scale = read['scale'] * read['ratio']

    @property
    def contrast(self):
        """How far each pixel is from the background, (height, width)."""
        return np.linalg.norm(self.pixels - rgb(self.look['background']), axis=2)

    def place(self, x, y):
        """Return where a point (m) has to be, px, by the definition of the view alone."""
        height, width, _ = self.pixels.shape
        return width / 2 + (x - self.x) * self.scale, height / 2 - (y - self.y) * self.scale

    def colour(self, x, y):
        """Return the colour at a point (m)."""
        px, py = self.place(x, y)
        return self.pixels[int(py), int(px)]

    def find(self, x, y, radius):
        """
        Return the centre and radius, px, of what is drawn around an expected circle (px).

        From the pixels alone: its border is where they differ from the background by more than half as much as the
        rim does, and what lies between in a row belongs to the circle too.
        """
        reach = radius + 8
        left, top = int(x - reach), int(y - reach)
        box = np.s_[top : int(y + reach) + 1, left : int(x + reach) + 1]
        contrast, window = self.contrast[box], self.pixels[box]
        # The darker rim is what the edge is blended from.
        rim = 0.55 * window[window.shape[0] // 2, window.shape[1] // 2]
        border = contrast > 0.5 * np.linalg.norm(rim - rgb(self.look['background']))
        from_left = np.logical_or.accumulate(border, axis=1)
        from_right = np.logical_or.accumulate(border[:, ::-1], axis=1)[:, ::-1]
        inside = from_left & from_right
        rows, columns = np.nonzero(inside)
        centre = left + columns.mean() + 0.5, top + rows.mean() + 0.5
        return *centre, math.sqrt(inside.sum() / math.pi)


def pixels_of(page, name):
    """Return the pixels of a 2-D canvas, (height, width, 4), from the top: `overlay` is what lies over the picture."""
    read = page.evaluate(READ_CANVAS, name)
    shape = read['height'], read['width'], 4
    return np.frombuffer(base64.b64decode(read['pixels']), np.uint8).reshape(shape).astype(int)


def rgb(code):
    return np.array([int(code[i : i + 2], 16) for i in (1, 3, 5)], float)


def is_near(pixels, colour, within=40):
    """Return where pixels have nearly this colour."""
    return np.linalg.norm(np.asarray(pixels)[..., :3] - rgb(colour), axis=-1) < within
