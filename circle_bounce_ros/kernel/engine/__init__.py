"""
The event-driven engine: from contact to contact, each found in closed form.

`records` says what is kept of each body and `motion` where it is, `build` makes a world from a scene and `cells` its
grid, `grid` tells who is near, `plan` finds what a circle does next, `tournament` which plan is the earliest,
`bounce` carries a contact out and `loop` runs from event to event; `alone` does it for circles that hit nobody who
moves, `ahead` looks ahead for the sake of speed. `driver` runs all that in one of the two `modes`: plain, or
compiled by `compilation`.
"""
