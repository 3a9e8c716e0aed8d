from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = 'circle_bounce_ros'


def share(*folders):
    """Return data_files entries that put the files of these folders where ament looks for them."""
    return [
        (
            f'share/{PACKAGE}/{folder}',
            [str(file) for file in sorted(Path(folder).iterdir()) if file.is_file()],
        )
        for folder in folders
    ]


setup(
    name=PACKAGE,
    version='0.1.0',
    description='Exact event-driven simulation of bouncing circles for ROS 2',
    license='Apache-2.0',
    author='circle_bounce_ros developers',
    author_email='developers@circle-bounce-ros.example.com',
    maintainer='circle_bounce_ros developers',
    maintainer_email='developers@circle-bounce-ros.example.com',
    url='https://circle-bounce-ros.example.com',
    project_urls={
        'Source': 'https://circle-bounce-ros.example.com/source',
        'Bug Tracker': 'https://circle-bounce-ros.example.com/issues',
    },
    python_requires='>=3.10,<3.14',
    packages=find_packages(include=[PACKAGE, f'{PACKAGE}.*']),
    package_data={f'{PACKAGE}.viewer': ['page/*']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{PACKAGE}']),
        (f'share/{PACKAGE}', ['package.xml', 'LICENSE']),
        *share('config', 'config/scenes', 'launch'),
    ],
    zip_safe=False,
    install_requires=['numpy>=1.26', 'PyYAML>=6.0', 'jsonschema>=4.10'],
    extras_require={
        # Where no ROS is installed: the same packages from PyPI.
        'ros': [
            'ros-jazzy-rclpy~=7.1.6',
            'ros-jazzy-rmw-fastrtps-cpp~=8.4.3',
            'ros-jazzy-common-interfaces~=5.3.6',
        ],
        # Compiles the engine, some fifty times faster; everything works without it.
        'fast': ['numba>=0.60'],
        'test': ['pytest>=7.4', 'hypothesis>=6.100', 'mcap-ros2-support>=0.5'],
        # Exact, because a new release of any of these finds new faults in the same code.
        'check': [
            'pytest-cov>=5',  # not in `test`: colcon would measure coverage because it is named there
            'ruff==0.17.6',
            'mypy==2.4.1',
            'import-linter==2.15',
            'types-PyYAML',
            'types-jsonschema',
        ],
        'docs': ['matplotlib>=3.8'],
        # Recordings, pictures and data sets: all that offline/ needs, where there is no ROS too.
        'offline': [
            'rosbags>=0.11.9',
            'mcap>=1.2',
            'pyarrow>=16',
            'tqdm>=4.66',
            'dask[distributed]>=2024.5',
            'matplotlib>=3.8',
            'pillow>=10.1',
        ],
        'test-offline': ['pytest>=8', 'mcap-ros2-support>=0.5'],
        'viewer': ['aiohttp>=3.9'],
        # Drives the Chromium of the system in the viewer's tests; it downloads none.
        'browser': ['playwright>=1.45'],
        # Who the engine is compared with, and what draws the comparison.
        'bench': ['pymunk>=7.0', 'box2d==2.3.10', 'billiards==0.5.0', 'matplotlib>=3.8'],
    },
    entry_points={
        'console_scripts': [
            'bounce_node = circle_bounce_ros.ros.main:main',
            'bounce_record = circle_bounce_ros.offline.commands:record_main',
            'bounce_plot = circle_bounce_ros.offline.commands:plot_main',
            'bounce_sweep = circle_bounce_ros.offline.commands:sweep_main',
            'bounce_viewer = circle_bounce_ros.viewer.main:main',
            'bounce_check = circle_bounce_ros.scene_file.check:check_main',
        ],
    },
)
