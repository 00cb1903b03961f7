"""Interfaces of the course's own."""

import rclpy
from rclpy.node import Node
from student_msgs.msg import Score
from student_msgs.srv import Average


class ScoreBook(Node):
    def __init__(self):
        super().__init__('score_book')
        self.scores = {}
        self.subscription = self.create_subscription(Score, 'score', self.on_score, 10)
        self.service = self.create_service(Average, 'average', self.on_average)

    def on_score(self, msg):
        self.scores.setdefault(msg.name, []).append(msg.points)

    def on_average(self, request, response):
        points = self.scores.get(request.name, [])
        response.found = bool(points)
        if points:
            response.average = sum(points) / len(points)
        return response


def main():
    rclpy.init()
    node = ScoreBook()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
