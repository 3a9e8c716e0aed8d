"""
The same simulation without ROS, as fast as it goes: recordings, pictures and data sets.

    Scene -> recording.moments -> bag, parquet          bounce_record
    scene or recording -> frames -> pictures            bounce_plot
    template x parameters x seeds -> runs -> summary    bounce_sweep

What is said on which topic, and how, is `encoding`'s, as for the node.
"""
