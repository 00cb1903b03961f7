# 画三角形
import turtle

t = turtle.Turtle()
t.pensize(3)
t.color('red')
for i in range(3):
    t.forward(200)
    t.left(120)
turtle.done()
