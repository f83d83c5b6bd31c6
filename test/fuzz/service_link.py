# SPDX-License-Identifier: BSD-3-Clause
"""Calls of a service over one lasting connection, with the bytes of a request as they are: rospy would refuse most of
the hostile ones before they are sent."""
import io
import socket
import struct

import rosgraph.network
import roslib.message
import rospy

PATIENCE = 120.0  # s for an answer, before the node counts as hung


class Hung(Exception):
    pass


class Died(Exception):
    pass


def zeros(kind):
    """The bytes of a message of this class with every field zero."""
    buffer = io.BytesIO()
    kind().serialize(buffer)
    return buffer.getvalue()


class ServiceLink:
    def __init__(self, name):
        self.name = name
        uri = rospy.get_master().lookupService(name)[2]
        host, port = uri[len('rosrpc://'):].rsplit(':', 1)
        self.address = host, int(port)
        self.socket = None
        self.type = roslib.message.get_service_class(self._connect('*')['type'])
        self._close()

    def call(self, request):
        """Whether the node could read the bytes of the request, and its answer or else the reason."""
        try:
            if not self.socket:
                self._connect(self.type._md5sum)
            self.socket.sendall(struct.pack('<I', len(request)) + request)
            read, length = struct.unpack('<BI', self._receive(5))
            answer = self._receive(length)
        except socket.timeout:
            raise Hung('no answer in %g s' % PATIENCE)
        except OSError as error:
            raise Died(error)
        if not read:
            self._close()
            return False, answer
        return True, self.type._response_class().deserialize(answer)

    def _close(self):
        self.socket.close()
        self.socket = None

    def _connect(self, checksum):
        self.socket = socket.create_connection(self.address, PATIENCE)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        fields = {'service': self.name, 'md5sum': checksum, 'callerid': '/service_fuzz', 'persistent': '1'}
        self.socket.sendall(rosgraph.network.encode_ros_handshake_header(fields))
        return rosgraph.network.read_ros_handshake_header(self.socket, io.BytesIO(), 4096)

    def _receive(self, length):
        parts = []
        while length > 0:
            part = self.socket.recv(min(length, 1 << 20))
            if not part:
                raise OSError('the connection was closed')
            parts.append(part)
            length -= len(part)
        return b''.join(parts)
