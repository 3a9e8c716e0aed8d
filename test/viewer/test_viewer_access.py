"""Whom the viewer lets in: this machine, its own page, its own few messages."""

import http.client
from urllib.parse import urlsplit

import aiohttp
import pytest
from viewing import PATIENCE, connected, run

from circle_bounce_ros.viewer.messages import LARGEST_MESSAGE


def get(address, path, **headers):
    """Return status and body of a request, whose path is sent exactly as it is."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=PATIENCE)
    try:
        connection.putrequest('GET', path, skip_host=True)
        for name, value in ({'Host': parts.netloc} | headers).items():
            connection.putheader(name, value)
        connection.endheaders()
        response = connection.getresponse()
        return response.status, response.read()
    finally:
        connection.close()


def test_it_listens_on_the_loopback_interface_only(lone_viewer):
    port = urlsplit(lone_viewer).port
    with open('/proc/net/tcp') as four, open('/proc/net/tcp6') as six:
        lines = [line.split() for line in [*four, *six]]
    listening = [line[1] for line in lines if line[1].endswith(f':{port:04X}') and line[3] == '0A']
    assert listening == [f'0100007F:{port:04X}']


@pytest.mark.parametrize(
    'headers',
    [
        {'Origin': 'http://example.com'},
        {'Origin': 'null'},
        {'Origin': 'http://127.0.0.1'},
        {'Origin': 'http://127.0.0.1:1'},
        {'Origin': 'https://127.0.0.1:{port}'},
        {'Origin': 'http://127.0.0.1:{port}.example.com'},
        {'Host': 'example.com'},
        {'Host': 'example.com:{port}'},
        {'Host': '127.0.0.1'},
        {'Host': '127.0.0.1:{port}.example.com'},
    ],
    ids=str,
)
def test_a_foreign_origin_or_host_is_refused(lone_viewer, headers):
    port = urlsplit(lone_viewer).port
    headers = {name: value.format(port=port) for name, value in headers.items()}
    for path in ('/', '/socket'):
        assert get(lone_viewer, path, **headers)[0] == 403

    async def look():
        with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
            async with connected(lone_viewer, **headers):
                pass
        assert refused.value.status == 403

    run(look())


def test_a_socket_without_an_origin_is_refused(lone_viewer):
    assert get(lone_viewer, '/socket')[0] == 403


def test_both_names_of_this_machine_are_served(lone_viewer):
    port = urlsplit(lone_viewer).port
    for name in ('127.0.0.1', 'localhost'):
        host = f'{name}:{port}'
        assert get(lone_viewer, '/', Host=host, Origin=f'http://{host}')[0] == 200


@pytest.mark.parametrize(
    'path',
    [
        '/../main.py',
        '/%2e%2e/main.py',
        '/..%2fmain.py',
        '/./../server.py',
        '//etc/passwd',
        '/page/index.html',
        '/main.js/../../server.py',
        '/index.html%00.js',
        '/\\..\\server.py',
        '/INDEX.HTML',
        '/server.py',
        '/.',
    ],
)
def test_only_its_own_files_are_served(lone_viewer, path):
    status, body = get(lone_viewer, path)
    assert status in (400, 404)
    assert b'import' not in body
    assert b'root:' not in body


@pytest.mark.parametrize(
    ('message', 'code'),
    [
        ('no JSON', aiohttp.WSCloseCode.POLICY_VIOLATION),
        ('{"type": "shutdown"}', aiohttp.WSCloseCode.POLICY_VIOLATION),
        ('{"type": "reset", "extra": 1}', aiohttp.WSCloseCode.POLICY_VIOLATION),
        (b'\x00', aiohttp.WSCloseCode.POLICY_VIOLATION),
        ('x' * (LARGEST_MESSAGE + 1), aiohttp.WSCloseCode.MESSAGE_TOO_BIG),
    ],
)
def test_who_says_anything_else_is_disconnected_and_the_others_stay(lone_viewer, message, code):
    async def look():
        async with connected(lone_viewer) as bad, connected(lone_viewer) as good:
            send = bad.socket.send_str if isinstance(message, str) else bad.socket.send_bytes
            await send(message)
            assert await bad.goodbye() == code
            await good.say(type='reset')
            await good.said(type='answer')

    run(look())
