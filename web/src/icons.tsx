/** Icons of the toolbar, drawn in lines of one weight on a grid of 16. */

const PATHS = {
  select: "M4 2.5 12 9.2 8.4 9.6 10.3 13.6 8.7 14.3 6.9 10.3 4 12.6Z",
  vehicle: "M4.5 13a1.8 1.8 0 1 1 0-3.6 1.8 1.8 0 0 1 0 3.6M6 10C8 8 8.5 6 10 5.2M10 2.5h3.6v3.6H10z",
  waypoint: "M2.5 12.5C5 12.5 5 8 8 8s3-4.5 5.5-4.5M6.2 6.2h3.6v3.6H6.2z",
  polygon: "M3 6.5 8.5 2.5 13.5 6 11.5 13 4.5 12.5Z",
  box: "M3 4h10v8H3z",
  line: "M2.5 12.5 6.5 5.5 10 9.5 13.5 3.5",
  undo: "M6 3.5 3 6.5 6 9.5M3.3 6.5H10a3 3 0 0 1 0 6H7",
  redo: "M10 3.5 13 6.5 10 9.5M12.7 6.5H6a3 3 0 0 0 0 6h3",
  fit: "M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10",
  plus: "M8 3.5v9M3.5 8h9",
  minus: "M3.5 8h9",
  layers: "M8 2.5 14 6 8 9.5 2 6ZM2.5 9 8 12.3 13.5 9",
  theme: "M8 2.5a5.5 5.5 0 1 0 0 11ZM8 2.5a5.5 5.5 0 0 1 0 11",
  help: "M6 6a2 2 0 1 1 2.8 1.8c-.6.3-.8.7-.8 1.5M8 11.6v.4",
  open: "M2.5 12.5v-9h4l1.5 2h5.5v7Z",
  save: "M3 3h8l2 2v8H3ZM5.5 3v3.5h4V3M5 13V9h6v4",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 16 16" width="16" height="16" aria-hidden="true" focusable="false">
      <path d={PATHS[name]} />
    </svg>
  );
}
