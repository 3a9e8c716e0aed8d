"""
The pictures of bounce_plot, one module each: a function of a source gives a figure and the numbers it shows.

`style` says how all of them look, `plane` how circles and walls are drawn.
"""
