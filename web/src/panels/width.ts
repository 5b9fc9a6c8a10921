/** How wide an element is on the screen. */

import type { RefObject } from "preact";
import { useEffect, useState } from "preact/hooks";

/** Width of an element [px], 0 until it is known. */
export function useWidth(ref: RefObject<HTMLElement | null>): number {
  const [width, setWidth] = useState(0);
  useEffect(() => {
    const element = ref.current;
    if (element === null) return undefined;
    const sizes = new ResizeObserver(() => setWidth(element.clientWidth));
    sizes.observe(element);
    return () => sizes.disconnect();
  }, [ref]);
  return width;
}
