"""Start bounce_node with the parameters of config/params.yaml."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

# Arguments that go before the file of parameters, when they are given.
PARAMETERS = {'scene': str, 'use_sim_time': bool}


def generate_launch_description():
    params_file = PathJoinSubstitution(
        [FindPackageShare('circle_bounce_ros'), 'config', 'params.yaml']
    )
    return LaunchDescription(
        [
            argument('params_file', params_file, 'YAML file of parameters'),
            argument('scene', '', 'packaged scene or path of a scene file'),
            argument('use_sim_time', '', 'follow /clock (true or false)'),
            argument('namespace', '', 'namespace of all topics and services'),
            OpaqueFunction(function=start_node),
        ]
    )


def argument(name, default, description):
    return DeclareLaunchArgument(name, default_value=default, description=description)


def start_node(context):
    given = {
        name: ParameterValue(LaunchConfiguration(name), value_type=kind)
        for name, kind in PARAMETERS.items()
        if LaunchConfiguration(name).perform(context)
    }
    return [
        Node(
            package='circle_bounce_ros',
            executable='bounce_node',
            name='bounce',
            namespace=LaunchConfiguration('namespace'),
            output='screen',
            parameters=[LaunchConfiguration('params_file'), *([given] if given else [])],
        )
    ]
