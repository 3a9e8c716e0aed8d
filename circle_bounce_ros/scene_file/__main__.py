"""`python -m circle_bounce_ros.scene_file FILE...` is bounce_check."""

from circle_bounce_ros.scene_file.check import check_main

if __name__ == '__main__':
    raise SystemExit(check_main())
