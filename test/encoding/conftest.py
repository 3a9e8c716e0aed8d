import warnings

with warnings.catch_warnings():
    # lark, which ROS's message support imports at its first use, imports what Python 3.11 deprecated.
    warnings.simplefilter('ignore', DeprecationWarning)
    import rosidl_generator_py  # noqa: F401 - for its side effect, here and not in the midst of a test
