"""Start bounce_node with the parameters of config/params.yaml, and what shows it."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
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
    rviz_layout = PathJoinSubstitution(
        [FindPackageShare('circle_bounce_ros'), 'config', 'bounce.rviz']
    )
    return LaunchDescription(
        [
            argument('params_file', params_file, 'YAML file of parameters'),
            argument('scene', '', 'packaged scene or path of a scene file'),
            argument('use_sim_time', '', 'follow /clock (true or false)'),
            argument('namespace', '', 'namespace of all topics and services'),
            argument('viewer', 'false', 'serve the live page too (true or false)'),
            argument('port', '8080', 'port of the live page on 127.0.0.1'),
            argument('rviz', 'false', 'start RViz too (true or false)'),
            OpaqueFunction(function=start_node),
            Node(
                package='circle_bounce_ros',
                executable='bounce_viewer',
                name='bounce_viewer',
                namespace=LaunchConfiguration('namespace'),
                output='screen',
                parameters=[{'port': ParameterValue(LaunchConfiguration('port'), value_type=int)}],
                condition=IfCondition(LaunchConfiguration('viewer')),
            ),
            Node(
                package='rviz2',
                executable='rviz2',
                # The layout's topics are relative, so they are those of the namespace.
                namespace=LaunchConfiguration('namespace'),
                arguments=['-d', rviz_layout],
                condition=IfCondition(LaunchConfiguration('rviz')),
            ),
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
