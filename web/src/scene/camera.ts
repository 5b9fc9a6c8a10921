/** From meters to pixels of the canvas and back: y goes up on the map, down on the screen. */

export class Camera {
  /** Center of the canvas [m]. */
  readonly x: number;
  readonly y: number;
  /** Pixels per meter. */
  readonly scale: number;
  /** Size of the canvas [px]. */
  readonly width: number;
  readonly height: number;

  constructor(x: number, y: number, scale: number, width: number, height: number) {
    this.x = x;
    this.y = y;
    this.scale = scale;
    this.width = width;
    this.height = height;
  }

  toScreen(x: number, y: number): [px: number, py: number] {
    return [this.px(x), this.py(y)];
  }

  /** As `toScreen`, one number at a time, which allocates nothing. */
  px(x: number): number {
    return (x - this.x) * this.scale + this.width / 2;
  }

  py(y: number): number {
    return (this.y - y) * this.scale + this.height / 2;
  }

  toMap(px: number, py: number): [x: number, y: number] {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
  }

  resized(width: number, height: number): Camera {
    return new Camera(this.x, this.y, this.scale, width, height);
  }

  panned(dx: number, dy: number): Camera {
    const { scale } = this;
    return new Camera(this.x - dx / scale, this.y + dy / scale, scale, this.width, this.height);
  }

  /** Zoomed by a factor about a point of the screen, which stays. */
  zoomed(factor: number, px: number, py: number): Camera {
    const scale = Math.min(Math.max(this.scale * factor, MIN_SCALE), MAX_SCALE);
    const [x, y] = this.toMap(px, py);
    const moved = new Camera(x, y, scale, this.width, this.height);
    return moved.panned(px - this.width / 2, py - this.height / 2);
  }
}

/** Largest and smallest zoom [px/m]: a fleet of ships to a table-top robot. */
const MIN_SCALE = 1e-5;
const MAX_SCALE = 1e6;
