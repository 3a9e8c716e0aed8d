"""
Which instants of a scene are shown, when, and with which stamp: the same for the node and for recordings.

All times are whole nanoseconds. `times` has the constants and conversions, `schedules` one class for each kind of
clock, `recording` the ticks of a recording, `slices` how a simulation gets to an instant without blocking anybody.
"""
