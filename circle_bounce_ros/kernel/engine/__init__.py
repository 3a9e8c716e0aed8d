"""
Event-driven molecular dynamics of hard disks: from contact to contact, each found in closed form.

The method is that of Alder and Wainwright (1959), with the asynchronous local clocks of Lubachevsky (1991) and lazy
invalidation of events. One file for each word of it:

    records             what is kept of each body, and the world that holds them
    motion              where a body is between two of its events
    wall_segments       from the walls of a scene to straight segments
    build, grid_layout  the world of a scene, and its grid
    broad_phase         cell lists in a hierarchical grid: the candidates for a contact
    prediction          event prediction: the next contact of a circle, and its next change of cell
    event_queue         a priority queue: a winner tree of the predicted events
    collision_response  the new velocities, and a line in the contact log
    loop                from event to event, in order of time
    independent         the same for circles that hit no other moving circle, without a queue
    prefetch            brings what comes next into the processor's cache
    backends            plain Python, or compiled by numba (`compilation`, kept on disk by `code_cache`)
    engines             what the simulation calls
"""
