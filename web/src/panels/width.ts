/** How wide an element is on the screen. */

import { useCallback, useRef, useState } from "preact/hooks";

/** A reference for an element, whenever it comes to be, and its width [px], 0 until it is known. */
export function useWidth(): readonly [ref: (element: HTMLElement | null) => void, width: number] {
  const [width, setWidth] = useState(0);
  const sizes = useRef<ResizeObserver | null>(null);
  const ref = useCallback((element: HTMLElement | null) => {
    sizes.current?.disconnect();
    sizes.current = null;
    if (element === null) return;
    sizes.current = new ResizeObserver(() => setWidth(element.clientWidth));
    sizes.current.observe(element);
  }, []);
  return [ref, width];
}
